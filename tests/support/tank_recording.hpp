#pragma once

#include <zlib.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox::test {

/// The tank recording (docs/formats.md, MATLAB level 5), decoded the short way for this one file, so that the tests of
/// the sonar layer need no reader from above it. Empty when the shared data are not there; throws when they are
/// damaged.
class TankRecording {
 public:
  static std::vector<Beam> beams(const std::filesystem::path& shared_data) {
    std::ifstream file(shared_data / "tank-static-mat" / "dataset_static.mat", std::ios::binary);
    if (!file) return {};
    const std::string packed((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return TankRecording(inflate(packed.substr(136))).decode();
  }

 private:
  struct Element {
    std::uint32_t type;
    std::size_t begin, bytes, next;
  };

  explicit TankRecording(std::string bytes) : bytes_(std::move(bytes)) {}

  static std::string inflate(const std::string& packed) {
    std::string out(8U << 20U, '\0');
    auto size = static_cast<uLongf>(out.size());
    const auto* in = reinterpret_cast<const Bytef*>(packed.data());
    if (uncompress(reinterpret_cast<Bytef*>(out.data()), &size, in, static_cast<uLong>(packed.size())) != Z_OK) {
      throw std::runtime_error("the tank recording does not inflate");
    }
    out.resize(size);
    return out;
  }

  template <class T>
  T number(std::size_t at) const {
    std::array<char, sizeof(T)> raw{};
    if (bytes_.size() < sizeof(T) || at > bytes_.size() - sizeof(T)) throw std::out_of_range("tank recording");
    std::memcpy(raw.data(), bytes_.data() + at, sizeof(T));
    return std::bit_cast<T>(raw);
  }

  Element element(std::size_t at) const {
    const auto word = number<std::uint32_t>(at);
    if (word >> 16U != 0) return {word & 0xffffU, at + 4, word >> 16U, at + 8};
    const std::size_t bytes = number<std::uint32_t>(at + 4);
    return {word, at + 8, bytes, at + 8 + (bytes + 7) / 8 * 8};
  }

  /// The numbers of a matrix: behind its flags, dimensions and name.
  Element numbers(const Element& matrix) const {
    const Element flags = element(matrix.begin);
    return element(element(element(flags.next).next).next);
  }

  std::vector<Beam> decode() const {
    const Element matrix = element(0);
    const Element flags = element(matrix.begin);
    const Element dimensions = element(flags.next);
    const auto count = number<std::uint32_t>(dimensions.begin + 4);
    const Element field_names = element(element(element(dimensions.next).next).next);
    std::size_t at = field_names.next;
    std::vector<Beam> beams;
    for (std::uint32_t n = 0; n < count; ++n) {
      std::array<Element, 4> fields{};  // time, angle, step_dist, intensities
      for (Element& field : fields) {
        const Element value = element(at);
        field = numbers(value);
        at = value.next;
      }
      const double clockwise_deg = number<float>(fields[1].begin);
      Beam beam{.time_s = number<float>(fields[0].begin),
                .bearing_rad = wrap_bearing(-clockwise_deg * std::numbers::pi / 180.0),
                .bin_length_m = number<float>(fields[2].begin),
                .intensities = {}};
      for (const char c : bytes_.substr(fields[3].begin, fields[3].bytes)) {
        beam.intensities.push_back(static_cast<std::uint8_t>(c));
      }
      beams.push_back(std::move(beam));
    }
    return beams;
  }

  std::string bytes_;
};

}  // namespace pingvox::test
