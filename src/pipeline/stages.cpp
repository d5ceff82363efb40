#include "snapwing/pipeline/stages.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "snapwing/common/error.h"
#include "snapwing/common/json_text.h"
#include "snapwing/common/provenance.h"

namespace snapwing::pipeline {

namespace {

using nlohmann::ordered_json;
using validation::Verdict;
namespace fs = std::filesystem;

constexpr char NOTES[] = "stages";     // folder of the notes
constexpr char INPUTS_NAME_IT[] = "";  // the program: of each stage another one, so that it is one of its inputs

/// The folder of the notes, made only in a folder that is new, empty or this run's own.
std::string notesIn(const std::string& folder) {
  const std::string notes = folder + "/" + NOTES;
  if (fs::is_directory(folder) && !fs::is_empty(folder) && !fs::is_directory(notes)) {
    throw common::FileError(folder,
                            "holds foreign files; allowed: a folder that is new or empty, or one that "
                            "`snapwing design arm --into` has begun");
  }
  common::makeFolder(notes);
  return notes;
}

std::string keyOf(const Inputs& inputs) {
  std::string text;
  for (const auto& [name, value] : inputs) text += name + "=" + value + ";";
  return common::sha256(text);
}

ordered_json jsonOf(const Inputs& inputs) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, value] : inputs) json[name] = value;
  return json;
}

Verdict verdictOf(const std::string& name) {
  for (const Verdict v : {Verdict::PASS, Verdict::UNDECIDED, Verdict::REPORTED}) {
    if (name == validation::verdictName(v)) return v;
  }
  return Verdict::FAIL;
}

/// Which of the note's files is not what the stage left, and why; empty: none.
std::string changedFile(const ordered_json& note, const std::string& folder) {
  const ordered_json files = note.value("files", ordered_json::object());
  for (const auto& [file, hash] : files.items()) {
    const std::string path = folder + "/" + file;
    if (!fs::is_regular_file(path)) return file + " no longer exists";
    if (common::sha256OfFile(path) != hash) return file + " is not what this stage left";
  }
  return "";
}

/// The stage's note as its result; none if a file is not what it was.
std::optional<StageResult> resultOf(const ordered_json& note, const std::string& folder) {
  if (!note.contains("files") || !changedFile(note, folder).empty()) return std::nullopt;
  StageResult result;
  result.verdict = verdictOf(note.value("verdict", ""));
  result.ends = note.value("ends", false);
  result.words = note.value("words", "");
  for (const auto& [file, hash] : note["files"].items()) result.files.push_back(file);
  result.kept = true;
  return result;
}

/// Names of the inputs in which a note and now differ.
std::string differences(const ordered_json& note, const Inputs& now) {
  const ordered_json was = note.value("inputs", ordered_json::object());
  std::string names;
  for (const auto& [name, value] : now) {
    if (was.value(name, "") != value) names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? "its inputs" : names;
}

}  // namespace

Stages::Stages(std::string folder, int count, std::function<void(const StageProgress&)> told)
    : folder_(std::move(folder)),
      kept_(notesIn(folder_), INPUTS_NAME_IT),
      lock_(folder_),
      count_(count),
      told_(std::move(told)) {}

void Stages::tell(StageProgress::What what, const std::string& words, Verdict verdict, double share) {
  if (told_) told_({what, number_, count_, stage_, words, share, verdict});
}

void Stages::working(const std::string& words, double share) {
  tell(StageProgress::What::WORKING, words, Verdict::REPORTED, share);
}

std::string Stages::notedHash(const std::string& stage, const std::string& file) const {
  const std::optional<ordered_json> note = kept_.loadAny(stage);
  return note && note->contains("files") ? (*note)["files"].value(file, "") : "";
}

std::string Stages::whyAnew(const std::string& stage, const Inputs& inputs) const {
  const std::string key = keyOf(inputs);
  if (const auto note = kept_.loadAny(stage)) {
    if (!kept_.load(stage, key)) return "anew: changed since it was done: " + differences(*note, inputs);
    const std::string changed = changedFile(*note, folder_);
    if (!changed.empty()) return "anew: " + changed;
  }
  const auto begun = kept_.loadAny(stage + ".begun");
  if (!begun) return "";
  if (kept_.load(stage + ".begun", key)) return "goes on";
  return "anew: changed since it was begun: " + differences(*begun, inputs);
}

StageResult Stages::run(const std::string& stage, const Inputs& inputs,
                        const std::function<StageResult(bool goes_on)>& work) {
  ++number_, stage_ = stage;
  const std::string key = keyOf(inputs);
  if (const auto note = kept_.load(stage, key)) {
    if (auto result = resultOf(*note, folder_)) {
      result->stage = stage;
      tell(StageProgress::What::KEPT, result->words, result->verdict, 1);
      return *result;
    }
  }
  const std::string why = whyAnew(stage, inputs);
  tell(StageProgress::What::BEGUN, why, Verdict::REPORTED, std::numeric_limits<double>::quiet_NaN());
  const bool goes_on = kept_.load(stage + ".begun", key).has_value();
  kept_.forget(stage);
  kept_.save(stage + ".begun", key, ordered_json{{"inputs", jsonOf(inputs)}});
  StageResult result = work(goes_on);
  result.stage = stage;
  ordered_json files = ordered_json::object();
  for (const std::string& file : result.files) files[file] = common::sha256OfFile(path(file));
  kept_.save(stage, key,
             ordered_json{{"inputs", jsonOf(inputs)},
                          {"verdict", validation::verdictName(result.verdict)},
                          {"ends", result.ends},
                          {"words", common::shownBytes(result.words)},
                          {"files", files}});
  tell(StageProgress::What::DONE, result.words, result.verdict, 1);
  return result;
}

}  // namespace snapwing::pipeline
