// Empty: see CMakeLists.txt.
