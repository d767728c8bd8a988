#pragma once

#include <memory>
#include <optional>
#include <string>

#include "io/bags/bag.hpp"
#include "io/bags/bag_topics.hpp"
#include "pingvox/io/beams.hpp"
#include "pingvox/map/point_scan.hpp"

// The scans of points in bags (docs/formats.md). A LaserScan is one where it looks in several directions.
namespace pingvox {

/// A topic whose messages may be scans; nullopt: they are not.
std::optional<KnownTopic> scan_topic(const BagTopic& topic);

/// The same as a question.
bool may_have_scans(const BagTopic& topic);

/// Whether a message of such a topic is a scan. REQUIRES a topic of scan_topic().
bool is_scan(const KnownTopic& topic, const BagMessage& message);

/// Scans in the frame of the sensor, with times. An error when there is none.
/// @param wanted   a topic; empty: the only one with scans
/// @param at_hand  message of the bag that is to be read first
Result<std::unique_ptr<ScanSource>> bag_scans(std::unique_ptr<Bag> bag, Damage damage, const std::string& wanted,
                                              const std::optional<BagMessage>& at_hand = std::nullopt);

}  // namespace pingvox
