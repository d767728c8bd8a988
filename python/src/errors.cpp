#include "errors.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "option_names.hpp"

namespace pingvox::python {
namespace {

std::string_view name_of(Error::Code code) {
  switch (code) {
    case Error::Code::kBadOption:
      return "bad_option";
    case Error::Code::kIo:
      return "io";
    case Error::Code::kCorrupt:
      return "corrupt";
    case Error::Code::kUnsupported:
      return "unsupported";
    case Error::Code::kLimit:
      return "limit";
    case Error::Code::kNoMemory:
      return "no_memory";
  }
  return "unsupported";
}

bool is_letter(char c) {
  return std::islower(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

void raise_usage(std::string message) {
  throw RaisedError({Error::Code::kBadOption, std::move(message)});
}

std::string with_keyword_names(std::string_view message) {
  std::string text;
  while (!message.empty()) {
    const bool begins = message.starts_with("--") && message.size() > 2 && is_letter(message[2]) &&
                        (text.empty() || text.back() != '-');
    if (!begins) {
      text += message.front();
      message.remove_prefix(1);
      continue;
    }
    message.remove_prefix(2);
    const auto end = std::ranges::find_if(message, [](char c) { return !is_letter(c) && c != '-'; });
    std::string name(message.begin(), end);
    message.remove_prefix(name.size());
    std::ranges::replace(name, '-', '_');
    text += name;
  }
  return text;
}

py::object error_object(const Error& error) {
  const py::object type = py::module_::import("pingvox._error").attr("Error");
  return type(with_keyword_names(app::with_option_names(error.message)), name_of(error.code));
}

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const RaisedError& raised) {
      const py::object error = error_object(raised.error());
      PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
    }
  });
}

}  // namespace pingvox::python
