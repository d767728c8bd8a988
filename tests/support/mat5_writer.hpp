#pragma once

#include <zlib.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// Writes MATLAB level-5 files piece by piece, right ones and wrong ones.
namespace pingvox::mat5_writer {

using Bytes = std::vector<std::uint8_t>;

template <class T>
void put(Bytes& to, T value, std::endian order) {
  std::uint8_t raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) to.push_back(raw[order == std::endian::native ? i : sizeof(T) - 1 - i]);
}

inline void append(Bytes& to, const Bytes& more) {
  to.insert(to.end(), more.begin(), more.end());
}

inline Bytes element(std::uint32_t type, const Bytes& data, std::endian order) {
  Bytes out;
  if (!data.empty() && data.size() <= 4) {
    put(out, static_cast<std::uint32_t>(data.size() << 16 | type), order);
    append(out, data);
    out.resize(8);
    return out;
  }
  put(out, type, order);
  put(out, static_cast<std::uint32_t>(data.size()), order);
  append(out, data);
  if (type != 15) out.resize((out.size() + 7) / 8 * 8);
  return out;
}

inline Bytes text_element(std::string_view text, std::endian order) {
  return element(1, Bytes(text.begin(), text.end()), order);
}

inline Bytes matrix_head(std::uint32_t matrix_class, std::initializer_list<std::int32_t> dimensions,
                         std::string_view name, std::endian order) {
  Bytes flags, extents, out;
  put(flags, matrix_class, order);
  put(flags, std::uint32_t{0}, order);
  for (const std::int32_t extent : dimensions) put(extents, extent, order);
  append(out, element(6, flags, order));
  append(out, element(5, extents, order));
  append(out, text_element(name, order));
  return out;
}

/// A nameless row of numbers, stored as T, of any class.
template <class T>
Bytes numbers(std::uint32_t matrix_class, std::uint32_t stored_type, const std::vector<T>& values, std::endian order) {
  Bytes data, out = matrix_head(matrix_class, {1, static_cast<std::int32_t>(values.size())}, "", order);
  for (const T value : values) put(data, value, order);
  append(out, element(stored_type, data, order));
  return element(14, out, order);
}

struct Record {
  float time = 0, angle = 0, step_dist = 0;
  std::vector<std::uint8_t> intensities;
};

inline Bytes struct_array(std::string_view name, const std::vector<std::string>& fields, std::size_t records,
                          const std::vector<Bytes>& arrays, std::endian order) {
  Bytes out = matrix_head(2, {1, static_cast<std::int32_t>(records)}, name, order);
  constexpr std::size_t kLength = 12;
  Bytes length, names;
  put(length, static_cast<std::int32_t>(kLength), order);
  for (const std::string& field : fields) {
    names.insert(names.end(), field.begin(), field.end());
    names.resize((names.size() / kLength + 1) * kLength);
  }
  append(out, element(5, length, order));
  append(out, element(1, names, order));
  for (const Bytes& array : arrays) append(out, array);
  return element(14, out, order);
}

/// `parsedData` as the recordings have it.
inline Bytes parsed_data(const std::vector<Record>& records, std::endian order) {
  std::vector<Bytes> arrays;
  for (const Record& r : records) {
    arrays.push_back(numbers<float>(7, 7, {r.time}, order));
    arrays.push_back(numbers<float>(7, 7, {r.angle}, order));
    arrays.push_back(numbers<float>(7, 7, {r.step_dist}, order));
    arrays.push_back(numbers<std::uint8_t>(6, 2, r.intensities, order));
  }
  return struct_array("parsedData", {"time", "angle", "step_dist", "intensities"}, records.size(), arrays, order);
}

inline Bytes compressed(const Bytes& matrix, std::endian order) {
  uLongf size = compressBound(static_cast<uLong>(matrix.size()));
  Bytes out(size);
  if (compress(out.data(), &size, matrix.data(), static_cast<uLong>(matrix.size())) != Z_OK) {
    throw std::runtime_error("compress");
  }
  out.resize(size);
  return element(15, out, order);
}

inline Bytes file(const std::vector<Bytes>& elements, std::endian order) {
  std::string text = "MATLAB 5.0 MAT-file";
  text.resize(116, ' ');
  Bytes out(text.begin(), text.end());
  out.resize(124);
  put(out, std::uint16_t{0x0100}, order);
  put(out, static_cast<std::uint16_t>('M' << 8 | 'I'), order);
  for (const Bytes& e : elements) append(out, e);
  return out;
}

}  // namespace pingvox::mat5_writer
