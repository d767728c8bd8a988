#include "pingvox/io/file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "support/logs.hpp"

namespace pingvox {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

Result<void> nothing(std::ostream&) {
  return {};
}

std::function<Result<void>(std::ostream&)> text(std::string content) {
  return [content = std::move(content)](std::ostream& out) -> Result<void> {
    out << content;
    return {};
  };
}

/// A folder of its own for each test, gone afterwards.
class Files : public testing::Test {
 protected:
  Files() {
    std::string pattern = testing::TempDir() + "/pingvox_files_XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~Files() override {
    std::error_code ignored;
    fs::permissions(folder_, fs::perms::owner_all, ignored);
    fs::remove_all(folder_, ignored);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string content(const std::string& name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    std::stringstream all;
    all << in.rdbuf();
    return all.str();
  }
  void put(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_)) all.push_back(entry.path().filename().string());
    return all;
  }
  mode_t mode(const std::string& name) const {
    struct stat status = {};
    EXPECT_EQ(::stat(path(name).c_str(), &status), 0);
    return status.st_mode & 07777;
  }

  fs::path folder_;
};

/// Root may do everything: the tests of rights are somebody else while this lives.
class Nobody {
 public:
  Nobody() : was_root_(::geteuid() == 0) {
    if (was_root_ && ::seteuid(65534) != 0) throw std::runtime_error("seteuid");
  }
  Nobody(const Nobody&) = delete;
  Nobody& operator=(const Nobody&) = delete;
  ~Nobody() {
    if (was_root_ && ::seteuid(0) != 0) std::abort();
  }

 private:
  bool was_root_;
};

TEST_F(Files, AreReadWhole) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{1} << 20, (std::size_t{3} << 20) + 17}) {
    std::string bytes(size, '\0');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7);
    put("in", bytes);
    const auto file = read_file(path("in"));
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->name, path("in"));
    EXPECT_TRUE(file->bytes == bytes_of(bytes)) << size;
  }
}

TEST_F(Files, OfTheSystemWithoutASizeAreRead) {
  const auto file = read_file("/proc/self/status");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_GT(file->bytes.size(), 100U);
}

TEST_F(Files, AreReadFromAPipe) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const std::string bytes(300'000, 'x');
  std::thread writer([&] { std::ofstream(path("pipe")) << bytes; });
  const auto file = read_file(path("pipe"));
  writer.join();
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->bytes == bytes_of(bytes));
}

TEST_F(Files, ThatCannotBeReadSayWhy) {
  const auto error_of = [](const std::string& name) {
    const auto file = read_file(name);
    EXPECT_TRUE(!file && file.error().code == Error::Code::kIo) << name;
    return file ? "" : file.error().message;
  };
  EXPECT_EQ(error_of(path("none")), path("none") + ": No such file or directory");
  EXPECT_EQ(error_of(folder_.string()),
            folder_.string() + ": is a folder without a bag of ROS 2: name the files in it");
  EXPECT_EQ(error_of(""), ": No such file or directory");
  // Kills a folder of logs of which one is mapped, and the others are not named.
  put("dive.db3", "x");
  EXPECT_TRUE(read_file(folder_.string()));
  put("dive.db3-wal", "x");
  EXPECT_TRUE(read_file(folder_.string())) << "SQLite's";
  put("dive.bin", "x");
  EXPECT_EQ(error_of(folder_.string()),
            folder_.string() + ": is a folder of a bag and other files: name those to read");
  put("metadata.yaml", "x");
  EXPECT_TRUE(read_file(folder_.string())) << "ROS 2's";
  put("secret", "x");
  fs::permissions(path("secret"), fs::perms::none);
  fs::permissions(folder_, fs::perms::all);
  const Nobody nobody;
  EXPECT_EQ(error_of(path("secret")), path("secret") + ": Permission denied");
}

TEST_F(Files, LargerThanTheMemoryAreRefused) {
  put("huge", "");
  // A hole costs no disk. An address space of 2 PB is more than there is.
  if (::truncate(path("huge").c_str(), off_t{1} << 43) != 0) GTEST_SKIP() << "no sparse file of 8 TB here";
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
#if defined(PINGVOX_SANITIZE_ADDRESS)
  GTEST_SKIP() << "an allocation that fails ends a program with AddressSanitizer";
#endif
  rlimit small = before;
  small.rlim_cur = rlim_t{1} << 40;
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &small), 0);
  const auto file = read_file(path("huge"));
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, Error::Code::kIo);
  EXPECT_EQ(file.error().message, path("huge") + ": does not fit into memory");
}

TEST_F(Files, AreWrittenWithTheUsualRights) {
  const mode_t mask = ::umask(027);
  ASSERT_TRUE(write_file(path("new"), text("hello")));
  EXPECT_EQ(content("new"), "hello");
  EXPECT_EQ(mode("new"), 0640U);
  ::umask(mask);
  EXPECT_THAT(names(), UnorderedElementsAre("new"));
}

TEST_F(Files, AreReplacedAndKeepTheirRights) {
  put("old", "a long text that was there before");
  ASSERT_EQ(::chmod(path("old").c_str(), 0604), 0);
  ASSERT_TRUE(write_file(path("old"), text("new")));
  EXPECT_EQ(content("old"), "new");
  EXPECT_EQ(mode("old"), 0604U);
  EXPECT_THAT(names(), UnorderedElementsAre("old"));
}

TEST_F(Files, OfTheWorkingDirectoryAreWritten) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  EXPECT_TRUE(write_file("here", text("x")));
  EXPECT_TRUE(write_file("./there", text("y")));
  fs::current_path(before);
  EXPECT_THAT(names(), UnorderedElementsAre("here", "there"));
}

TEST_F(Files, MayBeLargeAndBinary) {
  std::string bytes(5'000'001, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 31);
  ASSERT_TRUE(write_file(path("big"), [&](std::ostream& out) -> Result<void> {
    for (std::size_t i = 0; i < 1000; ++i) out.put(bytes[i]);
    out.write(bytes.data() + 1000, static_cast<std::streamsize>(bytes.size() - 1000));
    return {};
  }));
  EXPECT_TRUE(content("big") == bytes);
}

TEST_F(Files, StayAsTheyWereWhileTheirSuccessorIsWritten) {
  put("map", "old");
  ASSERT_TRUE(write_file(path("map"), [&](std::ostream& out) -> Result<void> {
    out << std::string(1'000'000, 'n') << std::flush;
    EXPECT_EQ(content("map"), "old");
    return {};
  }));
  EXPECT_EQ(content("map").size(), 1'000'000U);
}

TEST_F(Files, StayAsTheyWereWhenTheWriterFails) {
  put("map", "old");
  const auto written = write_file(path("map"), [](std::ostream& out) -> Result<void> {
    out << std::string(1'000'000, 'n');
    return fail(Error::Code::kUnsupported, "deeper than 16 levels");
  });
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Error::Code::kUnsupported);
  EXPECT_EQ(written.error().message, "deeper than 16 levels");
  EXPECT_EQ(content("map"), "old");
  EXPECT_THAT(names(), UnorderedElementsAre("map"));
}

TEST_F(Files, StayAsTheyWereWhenTheStreamWasBroken) {
  put("map", "old");
  const auto written = write_file(path("map"), [](std::ostream& out) -> Result<void> {
    out.setstate(std::ios::badbit);
    return {};
  });
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Error::Code::kIo);
  EXPECT_EQ(content("map"), "old");
  EXPECT_THAT(names(), UnorderedElementsAre("map"));
}

TEST_F(Files, StayAsTheyWereWhenMemoryRunsOut) {
  put("map", "old");
  EXPECT_THROW((void)write_file(path("map"), [](std::ostream&) -> Result<void> { throw std::bad_alloc(); }),
               std::bad_alloc);
  EXPECT_EQ(content("map"), "old");
  EXPECT_THAT(names(), UnorderedElementsAre("map"));
}

TEST_F(Files, StayAsTheyWereWhenTheDiskIsFull) {
  put("map", "old");
  // A limit on the size of files stands in for the end of the disk: a write comes back short, the next one fails.
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 100'000;
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto written = write_file(path("map"), text(std::string(1'000'000, 'n')));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, Error::Code::kIo);
  EXPECT_EQ(written.error().message, path("map") + ": File too large");
  EXPECT_EQ(content("map"), "old");
  EXPECT_THAT(names(), UnorderedElementsAre("map"));
}

TEST_F(Files, ThatAreDevicesAreWrittenWhereTheyAre) {
  EXPECT_TRUE(write_file("/dev/null", text("x")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  // The buffer hides the error until the end, or the writer sees it in between: the cause is the same.
  for (const std::size_t size : {std::size_t{1}, std::size_t{1'000'000}}) {
    const auto written = write_file("/dev/full", [size](std::ostream& out) -> Result<void> {
      if (out << std::string(size, 'x')) return {};
      return fail(Error::Code::kIo, "the beams could not be written");
    });
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, Error::Code::kIo);
    EXPECT_EQ(written.error().message, "/dev/full: No space left on device");
  }
}

TEST_F(Files, ThatArePipesAreWrittenWhereTheyAre) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = content("pipe"); });
  EXPECT_TRUE(write_file(path("pipe"), text("through")));
  reader.join();
  EXPECT_EQ(got, "through");
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
}

TEST_F(Files, BehindLinksAreReplacedAndTheLinksStay) {
  fs::create_directory(path("far"));
  put("far/map", "old");
  fs::create_symlink("far/map", path("near"));
  fs::create_symlink(path("near"), path("nearer"));
  fs::create_symlink("far/new", path("dangling"));
  ASSERT_TRUE(write_file(path("nearer"), text("new")));
  ASSERT_TRUE(write_file(path("dangling"), text("made")));
  EXPECT_TRUE(fs::is_symlink(path("nearer")));
  EXPECT_TRUE(fs::is_symlink(path("near")));
  EXPECT_EQ(content("far/map"), "new");
  EXPECT_EQ(content("far/new"), "made");

  fs::create_symlink("loop", path("loop"));
  EXPECT_FALSE(write_file(path("loop"), nothing));
}

TEST_F(Files, ThatCannotBeWrittenSayWhyAndAskTheWriterNothing) {
  const auto error_of = [](const std::string& name) {
    const auto written = write_file(name, [](std::ostream&) -> Result<void> {
      ADD_FAILURE() << "a map was written for nothing";
      return {};
    });
    EXPECT_TRUE(!written && written.error().code == Error::Code::kIo) << name;
    return written ? "" : written.error().message;
  };
  EXPECT_EQ(error_of(folder_.string()), folder_.string() + ": Is a directory");
  EXPECT_EQ(error_of(path("no/such/folder")), path("no/such/folder") + ": No such file or directory");
  EXPECT_EQ(error_of(path("new/")), path("new/") + ": No such file or directory");
  EXPECT_EQ(error_of(""), "a file to be written needs a name");
  put("file", "x");
  EXPECT_EQ(error_of(path("file/below")), path("file/below") + ": Not a directory");

  put("protected", "x");
  fs::permissions(path("protected"), fs::perms::owner_read | fs::perms::others_read);
  fs::permissions(folder_, fs::perms::all);
  {
    const Nobody nobody;
    EXPECT_EQ(error_of(path("protected")), path("protected") + ": Permission denied");
  }
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
  const Nobody nobody;
  EXPECT_EQ(error_of(path("new")), path("new") + ": Permission denied");
}

/// A process that writes a file and stops in the middle of it.
class HalfWritten {
 public:
  HalfWritten(const std::string& path, const std::string& content) {
    EXPECT_EQ(::pipe(from_child_), 0);
    EXPECT_EQ(::pipe(to_child_), 0);
    child_ = ::fork();
    if (child_ == 0) {
      const auto written = write_file(path, [&](std::ostream& out) -> Result<void> {
        out << content << std::flush;
        char byte = 0;
        if (::write(from_child_[1], "w", 1) != 1 || ::read(to_child_[0], &byte, 1) != 1) ::_exit(2);
        out << content;
        return {};
      });
      ::_exit(written ? 0 : 1);
    }
    char byte = 0;
    EXPECT_EQ(::read(from_child_[0], &byte, 1), 1);
  }
  HalfWritten(const HalfWritten&) = delete;
  HalfWritten& operator=(const HalfWritten&) = delete;
  ~HalfWritten() {
    for (const int fd : {from_child_[0], from_child_[1], to_child_[0], to_child_[1]}) ::close(fd);
  }

  void kill() {
    ::kill(child_, SIGKILL);
    EXPECT_TRUE(WIFSIGNALED(status()));
  }
  void finish() {
    EXPECT_EQ(::write(to_child_[1], "g", 1), 1);
    EXPECT_EQ(status(), 0);
  }

 private:
  int status() const {
    int status = -1;
    EXPECT_EQ(::waitpid(child_, &status, 0), child_);
    return status;
  }

  int from_child_[2] = {-1, -1}, to_child_[2] = {-1, -1};
  pid_t child_ = -1;
};

// Kills: a temporary file that nobody ever removes, and one that makes the next write fail.
TEST_F(Files, LeftByKilledProcessesAreRemovedByTheNextWrite) {
  put("map", "old");
  {
    HalfWritten first(path("map"), "first"), second(path("map"), "second");
    first.kill();
    second.kill();
  }
  EXPECT_EQ(content("map"), "old");
  EXPECT_EQ(names().size(), 3U) << "the test has to leave two behind";
  ASSERT_TRUE(write_file(path("map"), text("new")));
  EXPECT_EQ(content("map"), "new");
  EXPECT_THAT(names(), UnorderedElementsAre("map"));
}

// Kills: clearing away what another process is still writing.
TEST_F(Files, WrittenByAnotherProcessMeanwhileAreLeftToIt) {
  HalfWritten slow(path("map"), "slow");
  ASSERT_TRUE(write_file(path("map"), text("quick")));
  EXPECT_EQ(content("map"), "quick");
  EXPECT_EQ(names().size(), 2U);
  slow.finish();
  EXPECT_EQ(content("map"), "slowslow");
  EXPECT_THAT(names(), UnorderedElementsAre("map"));
}

// Kills: a temporary name that is longer than names may be, and one cut so that it removes another file's.
TEST_F(Files, WithTheLongestNamesAreWritten) {
  const std::string name(255, 'n');
  HalfWritten other(path(name.substr(0, 254) + "m"), "other");
  ASSERT_TRUE(write_file(path(name), text("x")));
  EXPECT_EQ(content(name), "x");
  other.finish();
  EXPECT_EQ(content(name.substr(0, 254) + "m"), "otherother");
}

TEST_F(Files, WrittenByManyAtOnceAreOneOfTheirs) {
  std::vector<std::thread> writers;
  for (char c = 'a'; c < 'i'; ++c) {
    writers.emplace_back([this, c] {
      for (int i = 0; i < 20; ++i) EXPECT_TRUE(write_file(path("map"), text(std::string(100'000, c))));
    });
  }
  for (std::thread& writer : writers) writer.join();
  const std::string last = content("map");
  EXPECT_EQ(last, std::string(100'000, last.empty() ? '?' : last[0]));
  EXPECT_THAT(names(), UnorderedElementsAre("map"));
}

/// The standard streams turned to a file while this lives.
class Redirected {
 public:
  Redirected(int fd, const std::string& path, int flags) : fd_(fd), saved_(::dup(fd)) {
    const int file = ::open(path.c_str(), flags, 0600);
    ::dup2(file, fd_);
    ::close(file);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;
  ~Redirected() {
    ::dup2(saved_, fd_);
    ::close(saved_);
  }

 private:
  int fd_, saved_;
};

TEST_F(Files, CalledDashAreTheStandardStreams) {
  put("in", "hello");
  {
    const Redirected input(STDIN_FILENO, path("in"), O_RDONLY);
    const auto file = read_file("-");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->name, "standard input");
    EXPECT_EQ(file->bytes, bytes_of("hello"));
  }
  {
    const Redirected output(STDOUT_FILENO, path("out"), O_WRONLY | O_CREAT);
    EXPECT_TRUE(write_file("-", text("world")));
  }
  EXPECT_EQ(content("out"), "world");
  std::string error;
  {
    const Redirected output(STDOUT_FILENO, "/dev/full", O_WRONLY);
    const auto written = write_file("-", text("world"));
    error = written ? "" : written.error().message;
  }
  EXPECT_EQ(error, "standard output: No space left on device");
}

}  // namespace
}  // namespace pingvox
