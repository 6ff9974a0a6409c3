/* SPDX-License-Identifier: GPL-2.0-or-later */
/* One page of HTML with what a person wants to see of a run first. */
#include "report/report.h"

static void print_begin(report *r) {
  const char *title = report_run_text(r, "title");
  gh_text_print(r->out,
                "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta name=\"viewport\" "
                "content=\"width=device-width, initial-scale=1\">\n<title>");
  report_escape(r->out, *title ? title : r->folder);
  gh_text_print(r->out, "</title>\n<style>\n");
  report_print_style(r->out);
  gh_text_print(r->out, "</style></head><body>\n");
}

static void print_end(report *r) {
  gh_text_print(r->out, "</main><p></p><div id=\"tip\"></div>\n<script>\n");
  report_print_script(r->out);
  gh_text_print(r->out, "</script></body></html>\n");
}

gh_status gh_report_write(gh_context *ctx, const char *folder, const int *points, int npoints,
                          const gh_comparison *comparison, const char *html) {
  static gh_status (*const sections[])(report *) = {report_verdict,  report_curves,     report_fields,
                                                    report_packings, report_comparison, report_convergence,
                                                    report_error,    report_time,       report_options};
  report r;
  if (!gh_h5_available())
    return gh_fail(
        ctx, GH_INPUT,
        "%s: a report is made of results.h5, and this granhom was built without HDF5 (make HDF5=0)", folder);
  GH_TRY(gh_results_check(ctx, folder));
  gh_status status = report_open(ctx, folder, points, npoints, &r);
  r.comparison = comparison;
  if (status == GH_OK) {
    print_begin(&r);
    for (size_t k = 0; k < sizeof sections / sizeof *sections && status == GH_OK; k++)
      status = sections[k](&r);
    print_end(&r);
  }
  if (status == GH_OK) status = gh_text_commit(r.out, html);
  report_close(&r);
  return status;
}
