#include "snapwing/validation/report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "line_plot.h"
#include "snapwing/common/json_text.h"
#include "snapwing/scene/rung.h"
#include "snapwing/validation/prediction_json.h"

namespace snapwing::validation {

namespace {

using motion::TrialRung;
using nlohmann::ordered_json;

const char* const STYLE =
    "<style>:root{color-scheme:light dark;--line:#8884;--pass:#1a7f37;--fail:#cf222e;--undecided:#9a6700}"
    "body{font:15px/1.45 system-ui,sans-serif;max-width:1320px;margin:1.5em auto;padding:0 1em}"
    "h1{margin:.2em 0}.verdict{font-size:1.25em;font-weight:600;padding:.4em .8em;border-left:6px solid}"
    ".pass{color:var(--pass)}.fail{color:var(--fail)}.undecided{color:var(--undecided)}table{border-collapse:collapse;"
    "width:100%;margin:.6em 0 1.4em}"
    "th,td{text-align:left;padding:.25em .6em;border-bottom:1px solid var(--line);vertical-align:top}"
    "td.n{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}"
    ".plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(460px,1fr));gap:1em}"
    "svg{width:100%;height:auto}svg text{font:12px system-ui,sans-serif;fill:currentColor}"
    "svg text.title{font-size:14px;font-weight:600}svg .grid{stroke:var(--line);stroke-width:1}"
    "@media print{.plots{display:block}}</style>\n";

std::string number(double value) {
  if (std::isnan(value)) return "";
  if (std::isinf(value)) return "no limit";
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string cell(const std::string& text, const std::string& kind = {}) {
  return "<td" + (kind.empty() ? "" : " class='" + kind + "'") + ">" + escaped(common::shownBytes(text)) + "</td>";
}

std::string checkRow(const Check& c) {
  const std::string kind = c.verdict == Verdict::PASS        ? "pass"
                           : c.verdict == Verdict::FAIL      ? "fail"
                           : c.verdict == Verdict::UNDECIDED ? "undecided"
                                                             : "";
  const std::string bar = c.error > 0 ? " &plusmn; " + number(c.error) : "";
  return "<tr>" + cell(verdictName(c.verdict), kind) + cell(c.name) + "<td class='n'>" + number(c.value) + bar +
         escaped(std::isfinite(c.value) ? " " + c.unit : "") + "</td>" + cell(allowedWords(c)) + cell(c.words) +
         "</tr>\n";
}

std::string checkTable(const Validation& found, bool gating) {
  std::string html = "<table><tr><th></th><th>what</th><th>found</th><th>" +
                     std::string(gating ? "allowed" : "met in use") + "</th><th></th></tr>\n";
  // What failed is read first.
  for (const Verdict verdict : {Verdict::FAIL, Verdict::UNDECIDED, Verdict::PASS, Verdict::REPORTED}) {
    if ((verdict != Verdict::REPORTED) != gating) continue;
    for (const Check& c : found.checks) {
      if (c.verdict == verdict) html += checkRow(c);
    }
  }
  return html + "</table>\n";
}

std::string curvePlot(const Validation& found, const vehicle::ForceTable& table) {
  PlotLine stated{"table (lumped rung)", table.travel, table.force, "#888", true};
  for (double& f : stated.y) f *= table.arm_count;
  std::vector<PlotLine> lines = {stated};
  for (const ArmCurve& curve : found.curves) {
    const bool finest = &curve == &found.curves.back();
    lines.push_back({"body, cells of " + number(1e3 * curve.cell_size) + " mm (planar)", curve.travel, curve.force,
                     finest ? "#0969da" : "#54aeff"});
  }
  // The far end, where arms are stretched straight, would hide peak and valley.
  const double second = table.travel.empty() ? NAN : vehicle::curveFeatures(table).second_travel;
  for (PlotLine& line : lines) {
    for (std::size_t k = 0; k < line.x.size(); ++k) {
      if (line.x[k] < 0 || line.x[k] > 1.15 * second) line.y[k] = NAN;
      line.x[k] = line.y[k] == line.y[k] ? 1e3 * line.x[k] : NAN;
    }
  }
  return linePlot("Force of all arms", "travel [mm]", "force [N]", lines);
}

std::string labelOf(const RungTrial& trial) {
  if (trial.rung == TrialRung::LUMPED) return motion::rungName(trial.rung);
  return motion::rungName(trial.rung) + ", " + scene::kernelName(trial.kernel) + ", " + number(1e3 * trial.cell_size) +
         " mm";
}

const char* colourOf(const ValidationTrial& t) {
  if (t.trial.rung == TrialRung::LUMPED) return "#888";
  if (t.trial.rung == TrialRung::PLANAR) return t.finer ? "#0a3069" : "#0969da";
  return t.trial.kernel == scene::SceneKernel::LINEAR_REDUCED ? "#8250df" : "#bf3989";
}

PlotLine travelOf(const ValidationTrial& t) {
  PlotLine line{labelOf(t.trial), t.outcome.time, t.outcome.travel, colourOf(t), t.trial.rung == TrialRung::LUMPED};
  for (double& u : line.y) u *= 1e3;
  return line;
}

std::string plots(const Validation& found, int plan) {
  std::vector<PlotLine> nominal, others;
  for (const ValidationTrial& t : found.trials) {
    if (t.plan != plan || t.trial.on_curve || t.outcome.time.empty()) continue;
    if (t.role == TrialRole::NOMINAL && !t.finer) nominal.push_back(travelOf(t));
    if (t.role == TrialRole::WEAKEST) others.push_back(travelOf(t));
  }
  const std::string name = found.plans[static_cast<std::size_t>(plan)].name();
  std::string html;
  if (!nominal.empty()) html += linePlot(name + ", nominal vehicle", "time [s]", "travel [mm]", nominal);
  if (!others.empty()) html += linePlot(name + ", weakest vehicles", "time [s]", "travel [mm]", others);
  return html;
}

std::string planTable(const Validation& found) {
  std::string html =
      "<table><tr><th>plan</th><th>throttle</th><th>duration</th><th>margin that it states</th>"
      "<th>mount, wings, pull</th><th>from</th></tr>\n";
  for (const PlanFile& p : found.plans) {
    html += "<tr>" + cell(p.name()) + cell(number(p.pulse.throttle), "n") + cell(pulseTimes(p.pulse), "n") +
            cell(number(p.worst_margin), "n") +
            cell(vehicle::mountName(p.trial.mount) + ", " + vehicle::wingsName(p.trial.wings) + ", " +
                 number(p.trial.gravity) + " m/s2") +
            cell(p.file.empty() ? "planned here" : p.file) + "</tr>\n";
  }
  return html + "</table>\n";
}

std::string trialTable(const Validation& found) {
  std::string html =
      "<table><tr><th>trial</th><th>ends in</th><th>snap [ms]</th><th>travel [mm]</th><th>CPU [s]</th>"
      "<th></th></tr>\n";
  for (const ValidationTrial& t : found.trials) {
    const RungOutcome& o = t.outcome;
    const bool carried = t.role == TrialRole::CARRIED, search = t.role == TrialRole::THRESHOLD || carried;
    const std::string limit =
        carried ? "carries " + number(o.threshold) + " N" : "shortest pulse " + number(1e3 * o.threshold) + " ms";
    html += "<tr>" + cell(t.name) + cell(search ? "" : vehicle::modeName(o.end)) +
            cell(number(1e3 * o.snap_time), "n") +
            cell(search ? "" : number(1e3 * o.least_travel) + " .. " + number(1e3 * o.peak_travel), "n") +
            cell(number(o.cpu_seconds), "n") + cell(search && o.failure.empty() ? limit : o.failure) + "</tr>\n";
  }
  return html + "</table>\n";
}

ordered_json checkJson(const Check& c) {
  return {{"name", c.name},   {"verdict", verdictName(c.verdict)},
          {"value", c.value}, {"error", c.error},
          {"low", c.low},     {"high", c.high},
          {"unit", c.unit},   {"words", c.words}};
}

}  // namespace

std::string reportHtml(const Validation& found, const vehicle::ForceTable& table, const ReportHead& head) {
  const bool good = found.passed();
  int failed = 0, passed = 0, open = 0;
  for (const Check& c : found.checks) {
    failed += c.verdict == Verdict::FAIL;
    passed += c.verdict == Verdict::PASS;
    open += c.verdict == Verdict::UNDECIDED;
  }
  const std::string title = "Validation of " + escaped(common::shownBytes(head.vehicle));
  std::string html = "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><title>" + title + "</title>\n" +
                     STYLE + "</head><body>\n<h1>" + title + "</h1>\n<p class='verdict " +
                     (good         ? "pass'>Passed: "
                      : failed > 0 ? "fail'>NOT passed: "
                                   : "undecided'>NOT decided: ") +
                     std::to_string(failed) + " of " + std::to_string(failed + passed + open) + " checks failed, " +
                     std::to_string(open) + " undecided</p>\n";
  html += "<h2>Checks</h2>\n" + checkTable(found, true);
  html += "<h2>Plans</h2>\n" + planTable(found);
  html += "<div class='plots'>\n" + curvePlot(found, table);
  for (std::size_t k = 0; k < found.plans.size(); ++k) html += plots(found, static_cast<int>(k));
  html +=
      "</div>\n<h2>Reported</h2>\n<p>Numbers that decide nothing. An accident decides if the vehicle file's "
      "must_survive "
      "names it.</p>\n" +
      checkTable(found, false);
  html += "<h2>Trials</h2>\n" + trialTable(found);
  html += "<h2>Made of</h2>\n<table><tr>" + cell("vehicle file") + cell(head.vehicle_file) + "</tr><tr>" +
          cell("force table") + cell(head.table_file) + "</tr><tr>" + cell("body of the solids") +
          cell(head.body_file) + "</tr><tr>" + cell("snapwing") + cell(head.version) + "</tr><tr>" + cell("command") +
          cell(head.command) + "</tr></table>\n</body></html>\n";
  return html;
}

std::string reportJson(const Validation& found, const ReportHead& head) {
  ordered_json checks = ordered_json::array(), trials = ordered_json::array();
  for (const Check& c : found.checks) checks.push_back(checkJson(c));
  for (const ValidationTrial& t : found.trials) {
    const RungOutcome& o = t.outcome;
    trials.push_back({{"name", t.name},
                      {"failure", o.failure},
                      {"end_mode", vehicle::modeName(o.end)},
                      {"snap_time", o.snap_time},
                      {"least_travel", o.least_travel},
                      {"peak_travel", o.peak_travel},
                      {"shortest_pulse", t.role == TrialRole::CARRIED ? NAN : o.threshold},
                      {"carried", t.role == TrialRole::CARRIED ? o.threshold : NAN},
                      {"cpu_seconds", o.cpu_seconds}});
  }
  return common::jsonText(ordered_json{{"vehicle", head.vehicle},
                                       {"vehicle_file", head.vehicle_file},
                                       {"vehicle_sha256", head.vehicle_sha256},
                                       {"table_file", head.table_file},
                                       {"body_file", head.body_file},
                                       {"snapwing_version", head.version},
                                       {"passed", found.passed()},
                                       {"undecided", found.undecided()},
                                       {"checks", checks},
                                       {"trials", trials}});
}

}  // namespace snapwing::validation
