// SPDX-License-Identifier: GPL-3.0-or-later

// The surface of a cloud in steps, which machines do side by side, each with files of its own.
//
// The cloud has shares: see JoinedPoints. Each is measured by itself; then each is counted into the
// cells of all; the counts are merged; the surface is made in parts; and these are joined.
// The mesh is, to the last bit, that of `reconstruct`, for any number of parts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"

namespace prefilter {

/// The files that steps leave, of one work.
struct StepFiles {
  std::string work;                   // what it is made of, in any words: other files are refused
  std::vector<std::string> measures;  // one a share, in their order
  std::vector<std::string> counts;    // likewise
  std::string cells;
  std::vector<std::string> parts;  // in their order
};

/// Throws Error for options that steps do not have: a depth or a cell size is needed, and the basis
/// must be Haar. All steps throw what `reconstruct` does, too, and for files of earlier steps that
/// are missing, damaged, or of another work. What they write is put in place when it is whole.
void check_steps(const ReconstructOptions& options);

/// Measures one share of a cloud, and writes measures[number].
void measure_step(PointSource* share, std::size_t number, const StepFiles& files,
                  const ReconstructOptions& options);

/// Counts the points of one share in the cells of all, and writes counts[number]. Needs all
/// measures. Throws Error where points may be far from all others, which `reconstruct` leaves out.
void count_step(PointSource* share, std::size_t number, const StepFiles& files,
                const ReconstructOptions& options);

/// Sums all counts up, and writes cells.
void merge_step(const StepFiles& files, const ReconstructOptions& options);

/// Makes one part of the surface, a range of slabs, and writes parts[number]. Needs all measures,
/// and cells. `attributes` is how many the joined cloud has.
void part_step(std::size_t number, std::size_t attributes, const StepFiles& files,
               const ReconstructOptions& options);

/// Hands the mesh of all parts on. Needs all measures, and all parts.
ReconstructReport join_step(std::size_t attributes, const StepFiles& files,
                            const ReconstructOptions& options, MeshSink* sink);

}  // namespace prefilter
