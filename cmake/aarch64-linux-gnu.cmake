# Cross-compiles for 64-bit ARM on Debian, with its arm64 packages (tools/arm64 installs them). Tests run under qemu-user.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
# Says at each use of std::minmax that its calling convention changed in g++ 10.
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)
