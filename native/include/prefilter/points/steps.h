// SPDX-License-Identifier: GPL-3.0-or-later

// Reconstructs a surface in steps that several machines can run in parallel, each with its own
// files.
//
// The cloud is divided into shares (see JoinedPoints). Each share is measured, then accumulated
// into a common grid of cells. The cells are merged, the surface is made in parts, and the parts
// are joined. The mesh is bitwise identical to that of `reconstruct`, for any number of parts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "prefilter/points/mesh_sink.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct.h"

namespace prefilter {

/// The files of all steps of one job.
struct StepFiles {
  std::string work;  // any text that identifies the job; files of another job are rejected
  std::vector<std::string> measures;  // one per share, in order
  std::vector<std::string> counts;    // one per share, in order
  std::string cells;
  std::vector<std::string> parts;  // in order
};

/// Throws Error for options that steps do not support: a depth or a cell size is required, and the
/// basis must be Haar. All steps also throw the errors of `reconstruct`, and Error for files of
/// earlier steps that are missing, damaged, or belong to another job. Files are renamed into place
/// once complete.
void check_steps(const ReconstructOptions& options);

/// Measures one share of a cloud, and writes measures[number].
void measure_step(PointSource* share, std::size_t number, const StepFiles& files,
                  const ReconstructOptions& options);

/// Accumulates the points of one share into the common cells, and writes counts[number]. Requires
/// all measures. Throws Error where there may be far outliers, which only `reconstruct` can
/// exclude.
void count_step(PointSource* share, std::size_t number, const StepFiles& files,
                const ReconstructOptions& options);

/// Sums all counts, and writes cells.
void merge_step(const StepFiles& files, const ReconstructOptions& options);

/// Makes one part of the surface, a range of slabs, and writes parts[number]. Requires all
/// measures, and cells. `attributes` is the number of attributes of the joined cloud.
void part_step(std::size_t number, std::size_t attributes, const StepFiles& files,
               const ReconstructOptions& options);

/// Outputs the mesh of all parts. Requires all measures and all parts.
ReconstructReport join_step(std::size_t attributes, const StepFiles& files,
                            const ReconstructOptions& options, MeshSink* sink);

}  // namespace prefilter
