#include "tank_maps.hpp"

#include "peer.hpp"
#include "pingvox/map/scan_update.hpp"
#include "same_map.hpp"
#include "tank_echoes.hpp"

namespace pingvox::bench {

Result<TankMaps> tank_maps() {
  const Result<TankBundles> bundles = tank_bundles(3);
  if (!bundles) return tl::unexpected(bundles.error());
  constexpr double kCell_m = 0.05;
  TankMaps maps{bundles->input, OccupancyMap({.resolution_m = kCell_m}), std::make_unique<octomap::OcTree>(kCell_m)};
  const LogOdds hit(maps.peer->getProbHitLog());
  ScanUpdate scan(maps.ours.lattice(), LogOdds(maps.peer->getProbMissLog()));
  for (const PeerScan& peer : peer_scans(bundles->scans)) {
    octomap::KeySet missed_cells, hit_cells;
    maps.peer->computeUpdate(peer.cloud, peer.origin_m, missed_cells, hit_cells, -1.0);
    for (const octomap::OcTreeKey& key : missed_cells) {
      maps.peer->updateNode(key, false);
      scan.add_miss(Key{key[0], key[1], key[2]});
    }
    for (const octomap::OcTreeKey& key : hit_cells) {
      maps.peer->updateNode(key, true);
      scan.add_hit(Key{key[0], key[1], key[2]}, hit);
    }
    if (const auto applied = maps.ours.apply(scan); !applied) return tl::unexpected(applied.error());
    scan.clear();
  }
  if (const auto same = check_identical(maps.ours, *maps.peer); !same) return tl::unexpected(same.error());
  return maps;
}

}  // namespace pingvox::bench
