// Times look-ups of points in a map: what lookups.py compares Python with.
//
//   python_lookups MAP POINTS    POINTS: x, y, z of each as doubles [m]
#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <vector>

#include "pingvox/io/file.hpp"
#include "pingvox/io/maps.hpp"

int main(int argc, char** argv) {
  using namespace pingvox;
  if (argc != 3) return 2;
  const Result<MapFile> file = read_file(argv[1]).and_then([](const FileBytes& bytes) { return read_map(bytes); });
  if (!file) return 1;
  std::ifstream in(argv[2], std::ios::binary);
  std::vector<Eigen::Vector3d> points;
  for (double numbers[3]; in.read(reinterpret_cast<char*>(numbers), sizeof numbers);) points.emplace_back(numbers);
  double best_s = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (int round = 0; round < 5; ++round) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<float> values(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto belief = file->map.at(points[i]);
      values[i] = belief ? belief->value() : std::numeric_limits<float>::quiet_NaN();
    }
    best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    for (const float value : values) sum += value == value ? value : 0.0F;
  }
  std::printf("%.9f %.6f\n", best_s, sum / 5.0);
}
