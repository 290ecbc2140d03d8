// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <utility>

#include "params/parameter_text.hpp"

namespace fdp_stereo {
namespace {

/// Builds the list; a parameter is one line in one of the add...() functions below.
class ParamList {
 public:
  void stage(const std::string& name) { stage_ = name; }

  ParamRef& add(const std::string& name, bool& value, const std::string& text) {
    return push(name, &value, 0.0, 1.0, "", text, "");
  }
  /// ros_name: where it is not stage_name, for stereo_image_proc has another one.
  template <typename Number>
  ParamRef& add(const std::string& name, Number& value, double min, double max, const std::string& unit,
                const std::string& text, const std::string& ros_name = "") {
    return push(name, &value, min, max, unit, text, ros_name);
  }
  template <typename Enum>
  ParamRef& add(const std::string& name, Enum& value, std::vector<std::string> names, const std::string& text) {
    const double last = static_cast<double>(names.size()) - 1.0;
    EnumRef ref{std::move(names), [&value] { return static_cast<int>(value); },
                [&value](int index) { value = static_cast<Enum>(index); }};
    return push(name, std::move(ref), 0.0, last, "", text, "");
  }

  std::vector<ParamRef> take() { return std::move(refs_); }

 private:
  ParamRef& push(const std::string& name, decltype(ParamRef::value) value, double min, double max,
                 const std::string& unit, const std::string& text, const std::string& ros_name) {
    refs_.push_back({stage_ + "." + name, std::move(value), min, max, unit, text,
                     ros_name.empty() ? stage_ + "_" + name : ros_name, TuningStep::kExpert});
    return refs_.back();
  }

  std::string stage_;
  std::vector<ParamRef> refs_;
};

void addPipeline(ParamList& list, PipelineParams& p) {
  list.stage("search");
  list.add("min_disparity", p.search.min, -1024, 1024, "px",
           "Smallest disparity searched; negative for verged cameras.", "min_disparity")
      .step = TuningStep::kSearch;
  list.add("num_disparities", p.search.count, 1, 1024, "px",
           "Number of disparities searched; more sees nearer things and costs time and memory.", "disparity_range")
      .step = TuningStep::kSearch;
  list.stage("pipeline");
  list.add("threads", p.threads, 0, 64, "", "Threads of one pair; 0 uses every core.", "threads");
  list.add("scale", p.scale, 0.25, 1.0, "",
           "Match smaller images, 0.5 = half the width and height, and enlarge the disparity along the edges of the "
           "full image: a fraction of the time and memory, less detail.")
      .step = TuningStep::kSearch;
  list.add("max_memory_mb", p.max_memory_mb, 64, 64000, "MB", "A pair that would need more memory is refused.",
           "max_memory_mb");
  list.stage("temporal");
  list.add("enabled", p.temporal.enabled,
           "In a stream, average the images where they stand still, so that the disparity does not flicker there.")
      .step = TuningStep::kFilters;
}

void addFeatureMatching(ParamList& list, FeatureMatchingParams& p) {
  list.stage("feature_matching");
  list.add("detector", p.detector, {"sift", "orb", "fast_census"},
           "Features that the matches come from: sift is the paper's, the others cost less.");
  list.add(
      "max_ratio", p.max_ratio, 0.1, 1.0, "",
      "Ratio of the best to the second-best distance above which a match is dropped (eq. 10); smaller is stricter.");
  list.add("max_row_difference_px", p.max_row_difference_px, 0.1, 10.0, "px",
           "Matches farther off their row are dropped; raise it for cameras that are not well rectified.");
  list.add("mutual_check", p.mutual_check, "Keep a match only if it is the best one from both views.");
  list.add("max_scale_ratio", p.max_scale_ratio, 0.0, 4.0, "",
           "Matches whose feature sizes differ by a larger factor are dropped; 0 = no check.");
  list.add("refine", p.refine, "Refine the right position of a match by least squares on the patches around it.");
  list.add("max_features", p.max_features, 10, 10000, "", "Features per view, the strongest first.");
}

void addRowAlignment(ParamList& list, RowAlignmentParams& p) {
  list.stage("row_alignment");
  list.add("enabled", p.enabled, "Repair imperfect rectification by resampling the rows of the right image.").step =
      TuningStep::kSearch;
  list.add("mode", p.mode, {"per_frame", "accumulate"},
           "Estimate the row offset from each pair alone, or gather the evidence over a stream.");
  list.add("model", p.model, {"auto", "constant", "affine", "quadratic", "radial"},
           "Shape of the row offset over the image; auto takes what the matches support.");
  list.add("warn_px", p.warn_px, 0.0, 5.0, "px", "A larger RMS row offset is reported as a calibration that is off.");
}

void addMatchingCost(ParamList& list, MatchingCostParams& p) {
  list.stage("matching_cost");
  list.add("type", p.type, {"rho_census", "ad_census", "census", "rho", "birchfield_tomasi", "learned"},
           "Measure of dissimilarity: rho_census (eq. 9), ad_census (eq. 6), one part alone, or learned: a small "
           "network beside rho_census.");
  list.add("census_width", p.census.window_width, 1, 31, "px",
           "Width of the census window, odd; larger holds weak texture and smears edges.");
  list.add("census_height", p.census.window_height, 1, 31, "px",
           "Height of the census window, odd; width x height may be at most 65.");
  list.add("scales", p.scales, 1, 3, "", "Census scales, the later ones on blurred images (eq. 7).");
  list.add("alpha", p.alpha, 0.0, 1.0, "", "Share of the gradient against the colour in rho (eq. 8).");
  list.add("lambda_rho", p.lambda_rho, 0.5, 50.0, "", "Scale of rho in theta (eq. 9); smaller saturates sooner.");
  list.add("lambda_census", p.lambda_census, 0.5, 100.0, "bits",
           "Scale of the census distance in theta (eq. 9); smaller saturates sooner.");
  list.add("rho_weight", p.rho_weight, 0.0, 4.0, "",
           "Factor of the rho or AD term beside the census term; 1 in the paper.");
  list.add("learned_weight", p.learned_weight, 0.0, 1.0, "",
           "Type learned: share of the network's cost; the rest is that of rho_census.");
  list.add("border", p.border, {"repeat_disparity", "repeat_pixel"},
           "Costs whose match is outside the right image: the pixel's nearest valid one along the disparities, or that "
           "of the nearest pixel of the row.");
  list.add(
      "adapt", p.adapt,
      "Measure noise, compression and sharpness of each pair, and smooth as far as they ask for it; good images are "
      "left as they are.");
}

void addSeeds(ParamList& list, SparseDisparityParams& sparse, DisparityPropagationParams& propagation) {
  list.stage("sparse_disparity");
  list.add("features", sparse.features,
           "Spread the feature matches as seeds; without, they only vouch for the seeds of other sensors.");
  list.add("reject_outliers", sparse.reject_outliers, "Drop seeds that contradict their neighbours.");
  list.add("max_deviation_px", sparse.max_deviation_px, 0.0, 2.0, "px",
           "Matches are rejected if small windows around them find disparities that differ by more on the mean.");
  list.stage("disparity_propagation");
  list.add("form", propagation.form, {"window", "surface"},
           "Spread one disparity over a window as published, or a slanted surface.");
  list.add("window", propagation.window, 1, 51, "px", "Form window: side of the window W_p, odd.");
  list.add("gamma", propagation.gamma, 1.0, 100.0, "grey levels",
           "Colour difference at which the influence of a seed falls to 1/e (eq. 11).");
  list.add("strength", propagation.strength, 0.0, 1.0, "",
           "Form surface: share of the seeds' prior in the cost of a pixel beside a trusted seed.")
      .step = TuningStep::kSeeds;
}

void addQuasiDense(ParamList& list, QuasiDenseParams& p) {
  list.stage("quasi_dense");
  list.add("enabled", p.enabled, "Match some rows roughly first and spread what is found along surfaces.").step =
      TuningStep::kSeeds;
  list.add("row_step", p.row_step, 1, 16, "px", "Every so many rows are matched; smaller costs time.");
  list.add("spacing_px", p.spacing_px, 1, 64, "px", "Distance of the seeds that are taken from the rows.");
  list.add("strength", p.strength, 0.0, 1.0, "",
           "Share of the seeds' prior in the costs; larger fills more places without texture, and more edges suffer.")
      .step = TuningStep::kSeeds;
}

void addOptimizers(ParamList& list, PipelineParams& p) {
  const std::vector<std::string> fits = {"none", "parabola", "equiangular", "blended"};
  list.stage("optimizer");
  list.add("type", p.optimizer, {"winner_takes_all", "semi_global", "local_expansion"},
           "How costs become disparities: from the fastest to the most accurate.")
      .step = TuningStep::kSmoothness;
  list.stage("semi_global");
  list.add("p1", p.semi_global.p1, 0.0, 5.0, "cost", "Penalty of a disparity that changes by 1 px; larger is smoother.")
      .step = TuningStep::kSmoothness;
  list.add("p2", p.semi_global.p2, 0.0, 20.0, "cost",
           "Penalty of a disparity that jumps, at least p1; larger is smoother.")
      .step = TuningStep::kSmoothness;
  list.add("p2_gradient", p.semi_global.p2_gradient, 0.0, 0.5, "1/grey level",
           "How fast the penalty of a jump falls where the image has an edge.");
  list.add("subpixel", p.semi_global.subpixel, fits, "Curve through the costs around the minimum.");
  list.add("uniqueness_ratio", p.semi_global.uniqueness_ratio, 0.0, 100.0, "%",
           "A pixel stays empty unless its best cost is this much below the next best.", "uniqueness_ratio")
      .step = TuningStep::kFilters;
  list.stage("winner_takes_all");
  list.add("subpixel", p.winner_takes_all.subpixel, fits, "Curve through the costs around the minimum.");
  list.add("uniqueness_ratio", p.winner_takes_all.uniqueness_ratio, 0.0, 100.0, "%",
           "A pixel stays empty unless its best cost is this much below the next best.");
}

void addLocalExpansion(ParamList& list, LocalExpansionParams& p) {
  list.stage("local_expansion");
  list.add("lambda", p.lambda, 0.0, 5.0, "cost", "Weight of the smoothness term (eq. 3); larger is smoother.");
  list.add("data_scale", p.data_scale, 0.01, 2.0, "", "Factor of the matching cost.");
  list.add("data_threshold", p.data_threshold, 0.01, 2.0, "cost",
           "Truncation of the matching cost after data_scale; smaller forgives occlusions, larger holds weak texture.");
  list.add("disparity_steps", p.disparity_steps, 1, 16, "1/px",
           "Costs per pixel of disparity; above 1 they are computed anew on resampled images, for sub-pixel accuracy.");
  list.add("filter_radius_px", p.filter_radius_px, 1, 50, "px", "Box radius of the guided filter of the data term.");
  list.add("unary_iterations", p.unary_iterations, 0, 20, "", "First rounds that leave out the smoothness term.");
  list.add("iterations", p.iterations, 0, 20, "", "Rounds of expansion moves; more lower the energy a little further.");
  list.add("right_iterations", p.right_iterations, 0, 20, "",
           "The same in the right view, which serves the check alone.");
  list.add("fine_random", p.fine.random, 0, 20, "",
           "Perturbed planes that one visit to a small cell offers; more search longer.");
  list.add("middle_random", p.middle.random, 0, 20, "", "The same for a middle cell.");
  list.add("coarse_random", p.coarse.random, 0, 20, "", "The same for a large cell.");
  list.add("seed", p.seed, 0, 1000, "", "Seed of the random numbers.");
  list.add("max_time_ms", p.max_time_ms, 0.0, 60000.0, "ms",
           "Return the best planes found after this time; 0 is no limit.");
  list.add("both_views", p.both_views, "Label the right view too, check one against the other and fill by planes.");
}

void addPostProcessing(ParamList& list, PipelineParams& p) {
  list.stage("left_right_check");
  list.add("enabled", p.left_right_check.enabled, "Drop disparities on which the two views disagree.");
  list.add("max_difference_px", p.left_right_check.max_difference_px, 0.0, 16.0, "px",
           "Largest difference between the views' disparities that is accepted.", "disp12MaxDiff")
      .step = TuningStep::kFilters;
  list.stage("speckle_filter");
  list.add("max_size", p.speckle_filter.max_size, 0, 2000, "px", "Regions of fewer pixels are dropped; 0 is off.",
           "speckle_size")
      .step = TuningStep::kFilters;
  list.add("max_difference_px", p.speckle_filter.max_difference_px, 0.0, 16.0, "px",
           "Neighbouring disparities closer than this belong to one region.", "speckle_range")
      .step = TuningStep::kFilters;
  list.stage("hole_closing");
  list.add("enabled", p.hole_closing.enabled, "Close tiny holes inside one surface from that surface.");
  list.stage("hole_filling");
  list.add("enabled", p.hole_filling.enabled, "Fill pixels without disparity from the background beside them.").step =
      TuningStep::kFilters;
  list.add("max_size", p.hole_filling.max_size, 0, 100000, "px", "Holes of more pixels stay; 0 fills all of them.");
  list.stage("weighted_median");
  list.add("radius", p.weighted_median.radius, 0, 7, "px", "Radius of the window of the weighted median; 0 is off.");
  list.add("gamma", p.weighted_median.gamma, 0.0, 100.0, "grey levels",
           "Colour difference at which a neighbour's weight falls to 1/e; 0 is the plain median.");
  list.stage("disparity_smoothing");
  list.add("radius", p.disparity_smoothing.radius, 0, 20, "px", "Reach of the edge-preserving mean; 0 is off.");
  list.add("gamma", p.disparity_smoothing.gamma, 1.0, 100.0, "grey levels",
           "Colour difference at which a neighbour's weight is halved.");
}

void requireOdd(const std::string& key, int value) {
  if (value % 2 == 0) throw std::invalid_argument(key + " = " + std::to_string(value) + ": must be odd");
}

/// What a range per value cannot say.
void validateTogether(const PipelineParams& p) {
  const CensusParams& census = p.matching_cost.census;
  requireOdd("matching_cost.census_width", census.window_width);
  requireOdd("matching_cost.census_height", census.window_height);
  const int bits = census.window_width * census.window_height - 1;
  if (bits < 1 || bits > 64) {
    throw std::invalid_argument("matching_cost.census_width x census_height = " + std::to_string(bits + 1) +
                                ": must be 2 to 65 pixels");
  }
  requireOdd("disparity_propagation.window", p.disparity_propagation.window);
  if (p.semi_global.p2 < p.semi_global.p1) {
    throw std::invalid_argument("semi_global.p2 = " + formatNumber(p.semi_global.p2) +
                                ": must be at least semi_global.p1 = " + formatNumber(p.semi_global.p1));
  }
}

}  // namespace

std::vector<ParamRef> paramList(PipelineParams& params) {
  ParamList list;
  addPipeline(list, params);
  addFeatureMatching(list, params.feature_matching);
  addRowAlignment(list, params.row_alignment);
  addMatchingCost(list, params.matching_cost);
  addSeeds(list, params.sparse_disparity, params.disparity_propagation);
  addQuasiDense(list, params.quasi_dense);
  addOptimizers(list, params);
  addLocalExpansion(list, params.local_expansion);
  addPostProcessing(list, params);
  return list.take();
}

void validate(const PipelineParams& params) {
  PipelineParams copy = params;
  for (const ParamRef& ref : paramList(copy)) {
    if (!inRange(ref, toNumber(ref))) reject(ref, formatNumber(toNumber(ref)));
  }
  validateTogether(params);
}

}  // namespace fdp_stereo
