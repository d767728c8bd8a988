#include "base/without_exceptions.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

namespace pingvox::detail {
namespace {

Error error_of(const std::function<void()>& thrower) {
  const Result<int> result = without_exceptions([&]() -> Result<int> {
    thrower();
    return 1;
  });
  EXPECT_FALSE(result);
  return result ? Error{} : result.error();
}

// Kills what memory ran out for that is told as anything else.
TEST(WithoutExceptions, MemoryThatRanOutIsNoMemory) {
  const auto too_long = [] { std::vector<int>().reserve(std::vector<int>().max_size() + 1); };
  for (const std::function<void()>& thrower :
       {std::function<void()>([] { throw std::bad_alloc(); }),
        std::function<void()>([] { throw std::bad_array_new_length(); }), std::function<void()>(too_long)}) {
    const Error error = error_of(thrower);
    EXPECT_EQ(error.code, Error::Code::kNoMemory);
    EXPECT_EQ(error.message, "out of memory");
  }
}

// Kills an error of the operating system that is told as memory that ran out.
TEST(WithoutExceptions, AnErrorOfTheSystemSaysWhich) {
  const Error no_thread =
      error_of([] { throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again)); });
  EXPECT_EQ(no_thread.code, Error::Code::kIo);
  EXPECT_EQ(no_thread.message, "Resource temporarily unavailable");
  const Error no_file = error_of([] { (void)std::filesystem::file_size("/nowhere/at all"); });
  EXPECT_EQ(no_file.code, Error::Code::kIo);
  EXPECT_NE(no_file.message.find("/nowhere/at all"), std::string::npos) << no_file.message;
}

// Kills a mistake of ours that is told as memory that ran out.
TEST(WithoutExceptions, AnyOtherIsNamed) {
  const std::vector<std::function<void()>> throwers = {
      [] { throw std::runtime_error("why"); },
      [] { (void)std::vector<int>(2).at(2); },
      [] { (void)std::optional<int>().value(); },
      [] { (void)std::get<0>(std::variant<int, double>(1.0)); },
      [] { (void)fmt::format(fmt::runtime("{:d}"), "text"); },
      [] { (void)Result<int>(fail(Error::Code::kIo, "lost")).value(); },
  };
  for (const auto& thrower : throwers) {
    std::string what;
    try {
      thrower();
    } catch (const std::exception& thrown) {
      what = thrown.what();
    }
    SCOPED_TRACE(what);
    const Error error = error_of(thrower);
    EXPECT_EQ(error.code, Error::Code::kUnsupported);
    EXPECT_EQ(error.message, "internal error: " + what);
  }
}

// Kills a name that is lost, or put before an error that was returned and names its file itself.
TEST(WithoutExceptions, TheNameIsPutBeforeWhatWasThrown) {
  const auto named = [](const std::function<Result<int>()>& f) { return without_exceptions("dive.log", f); };
  EXPECT_EQ(named([]() -> Result<int> { throw std::bad_alloc(); }).error().message, "dive.log: out of memory");
  EXPECT_EQ(named([]() -> Result<int> { throw std::runtime_error("why"); }).error().message,
            "dive.log: internal error: why");
  const Result<int> returned = named([]() -> Result<int> { return fail(Error::Code::kCorrupt, "dive.log: byte 3"); });
  EXPECT_EQ(returned.error().code, Error::Code::kCorrupt);
  EXPECT_EQ(returned.error().message, "dive.log: byte 3");
  EXPECT_EQ(named([]() -> Result<int> { return 7; }), 7);
}

}  // namespace
}  // namespace pingvox::detail
