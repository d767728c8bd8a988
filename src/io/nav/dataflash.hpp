#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pingvox/sonar/beam.hpp"

namespace pingvox {

/// Layout of the records of one type, as defined in the log.
struct DataflashType {
  struct Field {
    std::string label;
    char letter;         ///< of its kind
    std::size_t offset;  ///< from the end of the record's three bytes of header
  };

  std::string name;
  std::size_t length = 0;     ///< of the whole record
  std::vector<Field> fields;  ///< empty: the letters do not fill the record, so it is only stepped over

  const Field* field(std::string_view label) const;
};

/// One record of a DataFlash log.
struct DataflashRecord {
  const DataflashType& type;
  std::uint8_t number;                 ///< of the type
  std::span<const std::uint8_t> body;  ///< behind the header

  /// A field as a number, with the factor of its letter (c C e E: 0.01; L: degrees). nullopt: there is none of that
  /// name, or it is a text.
  std::optional<double> number_of(std::string_view label) const;
};

/// Walks through the records of a DataFlash log.
/// @return how many there were, those that define types included
std::size_t for_each_dataflash_record(std::span<const std::uint8_t> bytes, std::vector<DamageKind>& damage,
                                      const std::function<void(const DataflashRecord&)>& take);

}  // namespace pingvox
