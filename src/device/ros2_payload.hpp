#pragma once

#include <string>

struct ddsi_sertype;

namespace pingvox {

/// A type of Cyclone DDS whose samples are `std::string`s with the bytes of a message: no types are compiled in, and
/// contents are not parsed. To be given to dds_create_topic_sertype, which owns it from then on.
/// @param name  as DDS has it
/// @return nullptr without memory
ddsi_sertype* make_payload_type(const std::string& name);
/// Frees a type that no topic owns.
void free_payload_type(ddsi_sertype* type);

}  // namespace pingvox
