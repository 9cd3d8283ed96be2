#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// A board, or a piece of a cloud that may be one, in some sensor's frame.
struct FlatPiece {
  Eigen::Vector3d centre{0, 0, 0};  ///< [m]
  Eigen::Vector3d normal{0, 0, 0};  ///< unit, towards the sensor
};

// What the paper leaves open, and what stands here. It draws triples at random; here the triples of
// boards whose normals differ most are each tried with every triple of pieces that could be them:
// distances and angles between two are the same in both frames. The limits are ours.

struct PlaneMatchingOptions {
  int most_triples = 60;            ///< of boards
  double centre_m = 0.2;            ///< between a board's and its piece's centre
  double normal_rad = 0.10471976;   ///< 6 deg: between their normals
  std::size_t most_poses = 12;      ///< that are handed on
  double apart_rad = 0.0872664626;  ///< 5 deg: poses nearer to a better one are the same,
  double apart_m = 0.2;             ///< if their centres are, too

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// A pose, and how well boards lie on pieces there.
struct PlaneMatch {
  Rigid3 camera_from_lidar;
  double score = 0;        ///< of each board 1 where a piece is the same, 0 where none is near
  std::vector<int> piece;  ///< by board: the nearest; -1: none is near
};

/// The pieces nearest to the boards from a pose.
PlaneMatch MatchAt(const Rigid3& camera_from_lidar, const std::vector<FlatPiece>& boards,
                   const std::vector<FlatPiece>& pieces, const PlaneMatchingOptions& options = {});

/// The pose that lays three pieces on three boards, as the paper has it: the rotation from their
/// normals, then the translation from their centres' distances to the boards' planes. Normals must
/// differ.
Rigid3 PoseOfTriple(const FlatPiece (&boards)[3], const FlatPiece (&pieces)[3]);

/// Poses by triples, best first, each with its pieces. `boards`: camera axes; `pieces`: LIDAR
/// frame.
std::vector<PlaneMatch> MatchPlanes(const std::vector<FlatPiece>& boards,
                                    const std::vector<FlatPiece>& pieces,
                                    const PlaneMatchingOptions& options = {});

}  // namespace rgbdt
