#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/vectors.hpp"
#include "base/suggest.hpp"
#include "bench.hpp"
#include "speed/draw_ratios.hpp"

namespace {

using namespace pingvox;
using namespace pingvox::bench;

constexpr int kDone = 0, kCouldNotBeDone = 1, kInvalidUsage = 2;

constexpr std::string_view kUsage =
    "Usage: pingvox bench NAME... | all | list [--json] [--markdown] [--pictures DIR]\n"
    "Measures pingvox, beside OctoMap where that does the same work: each result is checked before it is timed.\n"
    "\n"
    "  NAME            one of `list`\n"
    "  all             each benchmark of speed, and what a vehicle asks for\n"
    "  list            their names\n"
    "  --json          one JSON object on standard output\n"
    "  --markdown      tables in Markdown\n"
    "  --pictures DIR  draw charts (and the paper's figures) into a folder\n"
    "  --quiet         say nothing on standard error while it runs\n"
    "\n"
    "PINGVOX_VECTORS=avx2 in the environment leaves out wider vector instructions, in the programs that it starts, "
    "too.\n"
    "\n"
    "Examples:\n"
    "  pingvox bench tank-3d tank-cone\n"
    "  pingvox bench all --json\n";

enum class Form { kTable, kJson, kMarkdown };

struct Call {
  std::vector<const Bench*> chosen;
  Form form = Form::kTable;
  BenchOptions options;
  bool shows_usage = false, shows_list = false;
};

void print_error(std::string_view message) {
  fmt::print(stderr, "pingvox: bench: {}\n", message);
}

void say(std::string_view line) {
  fmt::print(stderr, "{}\n", line);
}

bool is_in_all(const Bench& bench) {
  return bench.family == Family::kSpeed || bench.family == Family::kVehicle;
}

std::vector<std::string> known_words() {
  std::vector<std::string> words = {"all", "list", "--json", "--markdown", "--pictures", "--quiet", "--help"};
  for (const Bench& bench : benches()) words.emplace_back(bench.name);
  return words;
}

/// kBadOption when the usage is invalid.
Result<Call> parse(const std::vector<std::string>& words) {
  Call call;
  call.options.say = &say;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const std::size_t before = call.chosen.size();
    if (word == "--json") {
      call.form = Form::kJson;
    } else if (word == "--markdown") {
      call.form = Form::kMarkdown;
    } else if (word == "--quiet") {
      call.options.say = nullptr;
    } else if (word == "--help" || word == "-h") {
      call.shows_usage = true;
    } else if (word == "--pictures") {
      if (++i == words.size()) return fail(Error::Code::kBadOption, "--pictures wants a folder");
      call.options.pictures = words[i];
    } else if (word == "list") {
      call.shows_list = true;
    } else {
      for (const Bench& bench : benches()) {
        if (bench.name == word || (word == "all" && is_in_all(bench))) call.chosen.push_back(&bench);
      }
      if (call.chosen.size() == before) {
        return fail(Error::Code::kBadOption, fmt::format("there is no '{}'{}; `pingvox bench list` has the names", word,
                                                         did_you_mean(word, known_words())));
      }
    }
  }
  if (call.chosen.empty() && !call.shows_list) call.shows_usage = true;
  return call;
}

std::string list() {
  std::string out;
  for (const Bench& bench : benches()) out += fmt::format("{:<14} {}\n", bench.name, bench.what);
  return out;
}

std::string json_of(const std::vector<Row>& rows) {
  std::vector<JsonObject> objects;
  objects.reserve(rows.size());
  for (const Row& row : rows) objects.push_back(row.json());
  if (objects.size() == 1) return objects.front().text() + "\n";
  JsonObject all;
  all.add("benches", objects);
  return all.text() + "\n";
}

int run(const Call& call) {
  std::vector<Row> rows;
  int status = kDone;
  for (const Bench* bench : call.chosen) {
    if (call.options.say != nullptr) say(fmt::format("{}: {} ...", bench->name, bench->what));
    const Result<std::vector<Row>> result = bench->run(call.options);
    if (!result) {
      print_error(fmt::format("{}: {}", bench->name, result.error().message));
      status = kCouldNotBeDone;
      continue;
    }
    for (Row row : *result) {
      if (is_in_all(*bench)) row.add("vectors", app::vectors_in_use());
      rows.push_back(std::move(row));
    }
  }
  if (call.options.pictures) {
    if (const auto drawn = draw_ratios(rows, *call.options.pictures); !drawn) {
      print_error(drawn.error().message);
      status = kCouldNotBeDone;
    }
  }
  const std::string out = call.form == Form::kJson       ? json_of(rows)
                          : call.form == Form::kMarkdown ? markdown_of(rows)
                                                         : table_of(rows);
  if (std::fwrite(out.data(), 1, out.size(), stdout) != out.size() || std::fflush(stdout) != 0) {
    print_error("standard output does not take the result");
    return kCouldNotBeDone;
  }
  return status;
}

int run(const std::vector<std::string>& words) {
  if (const auto limited = app::limit_vectors(); !limited) {
    print_error(limited.error().message);
    return kInvalidUsage;
  }
  const Result<Call> call = parse(words);
  if (!call) {
    print_error(call.error().message);
    return kInvalidUsage;
  }
  if (call->shows_usage || call->shows_list) {
    fmt::print("{}", call->shows_usage ? std::string(kUsage) : list());
    return kDone;
  }
  return run(*call);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& exception) {
    print_error(exception.what());
    return kCouldNotBeDone;
  }
}
