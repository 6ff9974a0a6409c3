/* SPDX-License-Identifier: GPL-2.0-or-later */
/* Style and script of the report. */
#include "report/report.h"

/* c1 ... c6: of Okabe and Ito, told apart with every kind of colour vision; lighter ones on dark ground. */
static const char *const style[] = {
    ":root{--bg:#fff;--card:#fff;--ink:#1d2329;--soft:#5b6570;--line:#d9dee3;--faint:#eef1f4;",
    "--c1:#0072b2;--c2:#d55e00;--c3:#009e73;--c4:#b0568f;--c5:#8a6d00;--c6:#3a93c4;",
    "--good:#00704f;--warn:#8f4a00;--bad:#b3261e;--grain:#e3e7eb;--grainline:#b6bec6;--replica:#f3f5f7;",
    "--replicaline:#d5dade;--rattler:none}",
    "@media(prefers-color-scheme:dark){:root{--bg:#14181c;--card:#1a1f24;--ink:#e6eaee;--soft:#9aa5b0;",
    "--line:#38414a;--faint:#242b31;--c1:#56b4e9;--c2:#ff8a3c;--c3:#2fc69a;--c4:#e39ac8;--c5:#e0bd3b;",
    "--c6:#8ecdf2;--good:#4fd0a5;--warn:#ffb066;--bad:#ff8a80;--grain:#39424b;--grainline:#5d6872;",
    "--replica:#242b31;--replicaline:#3a444d}}",
    "*{box-sizing:border-box}",
    "body{margin:0;background:var(--bg);color:var(--ink);font:16px/1.5 system-ui,'Segoe UI',Roboto,",
    "'Helvetica Neue',Arial,sans-serif}",
    "main,header,nav div{max-width:1240px;margin:0 auto;padding:0 20px}",
    "h1{font-size:1.6rem;line-height:1.25;margin:1.4rem 0 .3rem}",
    "h2{font-size:1.25rem;margin:2.4rem 0 .6rem;padding-top:.4rem;border-top:1px solid var(--line);",
    "scroll-margin-top:3rem}",
    "h3{font-size:1rem;margin:1.4rem 0 .4rem}",
    "p{margin:.4rem 0;max-width:75ch;overflow-wrap:anywhere}.soft,.note{color:var(--soft)}",
    "nav{position:sticky;top:0;background:var(--bg);border-bottom:1px solid var(--line);z-index:2}",
    "nav div{display:flex;gap:1.1rem;overflow-x:auto;padding-top:.45rem;padding-bottom:.45rem}",
    "nav a{color:var(--c1);text-decoration:none;white-space:nowrap;font-size:.92rem}",
    "nav a:hover{text-decoration:underline}",
    ".verdict{border-left:5px solid;padding:.5rem .9rem;margin:.7rem 0;background:var(--faint)}",
    ".verdict b{display:block}.good{border-color:var(--good)}.warn{border-color:var(--warn)}",
    ".bad{border-color:var(--bad)}.good b{color:var(--good)}.warn b{color:var(--warn)}.bad "
    "b{color:var(--bad)}",
    ".tiles{display:grid;grid-template-columns:repeat(auto-fill,minmax(8.6rem,1fr));gap:.6rem;margin:.9rem "
    "0}",
    ".tiles div{border:1px solid var(--line);padding:.5rem .7rem}.tiles b{display:block;font-size:1.2rem;",
    "font-variant-numeric:tabular-nums}.tiles span{color:var(--soft);font-size:.85rem}",
    ".grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,21rem),1fr));gap:1.4rem "
    "1.8rem}",
    "figure{margin:0;min-width:0;max-width:36rem}figcaption{font-size:.95rem;font-weight:600;margin-bottom:."
    "2rem}",
    ".note{font-size:.85rem;margin:.3rem 0 0;line-height:1.4}.grid table{width:100%}.grid td{padding:.2rem "
    ".3rem}.grid td:first-child{white-space:normal}",
    "svg{display:block;width:100%;height:auto;overflow:visible}",
    "svg text{fill:var(--ink);font-size:13px;font-family:inherit}svg text.s{fill:var(--soft)}",
    "svg text.e{text-anchor:end}svg text.m{text-anchor:middle}svg "
    "text.ring{font-size:10.5px;paint-order:stroke;stroke:var(--bg);stroke-width:3px}",
    ".ax{stroke:var(--soft);fill:none}.gr{stroke:var(--line);fill:none}.lv{stroke:var(--soft);fill:none;",
    "stroke-dasharray:5 4}",
    ".ln{fill:none;stroke-width:1.8;stroke-linejoin:round}",
    ".hit{stroke:transparent;stroke-width:12;pointer-events:all}",
    ".key{display:flex;flex-wrap:wrap;gap:.1rem 1rem;font-size:.85rem;margin-top:.2rem}",
    ".key i{display:inline-block;width:1.1em;height:.55em;margin-right:.35em;border-radius:2px}",
    ".s1{stroke:var(--c1)}.s2{stroke:var(--c2)}.s3{stroke:var(--c3)}.s4{stroke:var(--c4)}.s5{stroke:var(--c5)"
    "}",
    ".s6{stroke:var(--c6)}.f1{fill:var(--c1);background:var(--c1)}.f2{fill:var(--c2);background:var(--c2)}",
    ".f3{fill:var(--c3);background:var(--c3)}.f4{fill:var(--c4);background:var(--c4)}",
    ".f5{fill:var(--c5);background:var(--c5)}.f6{fill:var(--c6);background:var(--c6)}",
    ".mesh g path{stroke-width:7;stroke-linejoin:round}.ed{stroke:#fff;stroke-opacity:.75;fill:none}",
    "path.un,.mesh g path.un{stroke:var(--soft);stroke-width:1.2px;fill:none;stroke-dasharray:5 "
    "4;vector-effect:non-scaling-stroke}",
    ".lost{fill:var(--c2);stroke:var(--c2)}.band{stroke:#111;stroke-width:2.2;fill:none}",
    ".g{fill:var(--grain);stroke:var(--grainline)}.r{fill:var(--replica);stroke:var(--replicaline)}",
    ".f{stroke:#b03a2e;stroke-width:3}"
    ".w{fill:none;stroke:var(--grainline);stroke-dasharray:7 5}",
    ".fc "
    "path{fill:none;stroke:var(--c1);stroke-linecap:round}.fs "
    "path{fill:none;stroke:var(--c4);stroke-linecap:round}.cell{fill:none;stroke:var(--c2);stroke-width:3}",
    ".tr{fill:none;stroke:var(--c1);stroke-width:3;stroke-linejoin:round}.dot{fill:var(--c2)}",
    ".scroll{overflow:auto;max-height:30rem;border:1px solid var(--line)}",
    "table{border-collapse:collapse;font-size:.84rem;font-variant-numeric:tabular-nums}",
    "th,td{padding:.2rem .5rem;text-align:right;white-space:nowrap;border-bottom:1px solid var(--faint)}",
    "th{font-weight:600;color:var(--soft);position:sticky;top:0;background:var(--bg)}",
    "th:first-child,td:first-child,.left{text-align:left}",
    "tr.cut td{color:var(--soft)}",
    "details{margin:.8rem 0}summary{cursor:pointer;color:var(--c1)}",
    "pre{overflow:auto;background:var(--faint);padding:.8rem;font-size:.82rem}",
    "dl{display:grid;grid-template-columns:max-content 1fr;gap:.1rem 1rem;margin:.3rem 0;font-size:.9rem}",
    "dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere;min-width:0}",
    ".slider{display:none;align-items:center;gap:.8rem;margin:.5rem 0 .9rem;flex-wrap:wrap}",
    ".slider input{flex:0 1 20rem;accent-color:var(--c1)}",
    "#tip{position:fixed;display:none;background:var(--ink);color:var(--bg);padding:.2rem .55rem;",
    "font-size:.82rem;pointer-events:none;z-index:3;max-width:22rem}",
    "figure svg{cursor:zoom-in}svg.big{position:fixed;inset:0;width:100vw;height:100vh;padding:14px;",
    "background:var(--bg);z-index:4;cursor:zoom-out}",
    "[hidden]{display:none!important}",
    "@media(max-width:30rem){main,header,nav div{padding-left:14px;padding-right:14px}svg "
    "text{font-size:14.5px}}",
    "@media print{nav,.slider{display:none!important}}"};

static const char *const script[] = {
    "const tip=document.getElementById('tip');",
    "function show(e){const t=e.target.closest&&e.target.closest('[data-t]');",
    "if(!t){tip.style.display='none';return}",
    "tip.textContent=t.dataset.t;tip.style.display='block';",
    "const x=Math.min(e.clientX+14,innerWidth-tip.offsetWidth-6),y=e.clientY-tip.offsetHeight-12;",
    "tip.style.left=Math.max(6,x)+'px';tip.style.top=(y<4?e.clientY+18:y)+'px'}",
    "addEventListener('pointermove',show);addEventListener('pointerdown',show);",
    "addEventListener('scroll',()=>tip.style.display='none');",
    "addEventListener('click',e=>{const s=e.target.closest('figure svg');",
    "for(const b of document.querySelectorAll('.big'))if(b!==s)b.classList.remove('big');",
    "if(s)s.classList.toggle('big')});",
    "addEventListener('keydown',e=>{if(e.key==='Escape')",
    "for(const b of document.querySelectorAll('.big'))b.classList.remove('big')});",
    "for(const s of document.querySelectorAll('.slider')){s.style.display='flex';",
    "const i=s.querySelector('input'),o=s.querySelector('output');",
    "i.addEventListener('input',()=>{",
    "for(const f of document.querySelectorAll('[data-frame]'))",
    "f.toggleAttribute('hidden',f.dataset.frame!==i.value);",
    "o.textContent=s.dataset.names.split('|')[i.value]})}"};

void report_print_style(gh_text *out) {
  for (size_t k = 0; k < sizeof style / sizeof *style; k++) gh_text_print(out, "%s\n", style[k]);
}

void report_print_script(gh_text *out) {
  for (size_t k = 0; k < sizeof script / sizeof *script; k++) gh_text_print(out, "%s\n", script[k]);
}
