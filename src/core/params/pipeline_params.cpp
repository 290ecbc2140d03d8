// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "fdp_stereo/pipeline_params.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <locale>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>

#include "params/presets.hpp"

namespace fdp_stereo {
namespace {

constexpr std::size_t kMaxYamlBytes = 1U << 20;
constexpr int kMaxYamlDepth = 4;

/// Builds the list; a parameter is one line in one of the add...() functions below.
class ParamList {
 public:
  void stage(const std::string& name) { stage_ = name; }

  void add(const std::string& name, bool& value, const std::string& text, const std::string& ros_name = "") {
    push(name, &value, 0.0, 1.0, "", text, ros_name);
  }
  template <typename Number>
  void add(const std::string& name, Number& value, double min, double max, const std::string& unit,
           const std::string& text, const std::string& ros_name = "") {
    push(name, &value, min, max, unit, text, ros_name);
  }
  template <typename Enum>
  void add(const std::string& name, Enum& value, std::vector<std::string> names, const std::string& text) {
    const double last = static_cast<double>(names.size()) - 1.0;
    EnumRef ref{std::move(names), [&value] { return static_cast<int>(value); },
                [&value](int index) { value = static_cast<Enum>(index); }};
    push(name, std::move(ref), 0.0, last, "", text, "");
  }

  std::vector<ParamRef> take() { return std::move(refs_); }

 private:
  void push(const std::string& name, decltype(ParamRef::value) value, double min, double max, const std::string& unit,
            const std::string& text, const std::string& ros_name) {
    refs_.push_back({stage_ + "." + name, std::move(value), min, max, unit, text,
                     ros_name.empty() ? stage_ + "_" + name : ros_name});
  }

  std::string stage_;
  std::vector<ParamRef> refs_;
};

void addPipeline(ParamList& list, PipelineParams& p) {
  list.stage("search");
  list.add("min_disparity", p.search.min, -1024, 1024, "px",
           "Smallest disparity searched; negative for verged cameras.", "min_disparity");
  list.add("num_disparities", p.search.count, 1, 1024, "px",
           "Number of disparities searched; more sees nearer things and costs time and memory.", "disparity_range");
  list.stage("pipeline");
  list.add("threads", p.threads, 0, 64, "", "Threads of one pair; 0 uses every core.", "threads");
  list.add(
      "scale", p.scale, 0.25, 1.0, "",
      "Match smaller images, 0.5 = half the width and height, and enlarge the disparity along the edges of the full "
      "image: a fraction of the time and memory, less detail.");
  list.add("max_memory_mb", p.max_memory_mb, 16, 65536, "MB", "A pair that would need more memory is refused.",
           "max_memory_mb");
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
  list.add("max_scale_ratio", p.max_scale_ratio, 0.0, 10.0, "",
           "Matches whose feature sizes differ by a larger factor are dropped; 0 = no check.");
  list.add("refine", p.refine, "Refine the right position of a match by least squares on the patches around it.");
  list.add("max_features", p.max_features, 10, 100000, "", "Features per view, the strongest first.");
}

void addRowAlignment(ParamList& list, RowAlignmentParams& p) {
  list.stage("row_alignment");
  list.add("enabled", p.enabled, "Repair imperfect rectification by resampling the rows of the right image.");
  list.add("mode", p.mode, {"per_frame", "accumulate"},
           "Estimate the row offset from each pair alone, or gather the evidence over a stream.");
  list.add("model", p.model, {"auto", "constant", "affine", "quadratic", "radial"},
           "Shape of the row offset over the image; auto takes what the matches support.");
  list.add("forgetting", p.forgetting, 0.0, 1.0, "",
           "With mode accumulate: share of its weight that a match keeps from frame to frame.");
  list.add("warn_px", p.warn_px, 0.0, 10.0, "px", "A larger RMS row offset is reported as a calibration that is off.");
}

void addMatchingCost(ParamList& list, MatchingCostParams& p) {
  list.stage("matching_cost");
  list.add("type", p.type, {"rho_census", "ad_census", "census", "rho", "birchfield_tomasi"},
           "Measure of dissimilarity: rho_census (eq. 9), ad_census (eq. 6), or one part alone.");
  list.add("census_width", p.census.window_width, 1, 31, "px",
           "Width of the census window, odd; larger holds weak texture and smears edges.");
  list.add("census_height", p.census.window_height, 1, 31, "px",
           "Height of the census window, odd; width x height may be at most 65.");
  list.add("scales", p.scales, 1, 3, "", "Census scales, the later ones on blurred images (eq. 7).");
  for (std::size_t i = 0; i < p.scale_weights.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    list.add("scale_weight_" + number, p.scale_weights[i], 0.0, 1.0, "",
             "Weight of census scale " + number + " (w_i of eq. 7), divided by the sum over the scales used.");
    list.add("scale_sigma_px_" + number, p.scale_sigmas_px[i], 0.0, 10.0, "px",
             "Gaussian blur of census scale " + number + "; 0 is none.");
  }
  list.add("alpha", p.alpha, 0.0, 1.0, "", "Share of the gradient against the colour in rho (eq. 8).");
  list.add("lambda_rho", p.lambda_rho, 0.1, 1000.0, "", "Scale of rho in theta (eq. 9); smaller saturates sooner.");
  list.add("lambda_census", p.lambda_census, 0.1, 1000.0, "bits",
           "Scale of the census distance in theta (eq. 9); smaller saturates sooner.");
  list.add("lambda_ad", p.lambda_ad, 0.1, 1000.0, "", "Scale of the absolute difference in theta (eq. 6).");
  list.add("rho_weight", p.rho_weight, 0.0, 10.0, "",
           "Factor of the rho or AD term beside the census term; 1 in the paper.");
  list.add("border", p.border, {"repeat_disparity", "repeat_pixel"},
           "Costs whose match is outside the right image: the pixel's nearest valid one along the disparities, or that "
           "of the nearest pixel of the row.");
}

void addSeeds(ParamList& list, SparseDisparityParams& sparse, DisparityPropagationParams& propagation) {
  list.stage("sparse_disparity");
  list.add("reject_outliers", sparse.reject_outliers, "Drop seeds that contradict their neighbours.");
  list.add("max_row_residual_px", sparse.max_row_residual_px, 0.05, 10.0, "px",
           "Matches farther off their row after row alignment are rejected.");
  list.add("max_deviation_px", sparse.max_deviation_px, 0.0, 2.0, "px",
           "Matches are rejected if small windows around them find disparities that differ by more on the mean.");
  list.add("min_support", sparse.min_support, 0.0, 1.0, "",
           "Share of its neighbours that a seed must agree with; larger rejects more.");
  list.add("tolerance_px", sparse.tolerance_px, 0.1, 10.0, "px",
           "Difference up to which two neighbouring seeds agree.");
  list.add("max_slope", sparse.max_slope, 0.0, 2.0, "px/px",
           "Steepest surface: neighbouring seeds may differ by this times their distance on top.");
  list.stage("disparity_propagation");
  list.add("enabled", propagation.enabled, "Lower the costs near the seeds (algorithm 1).");
  list.add("image_seeds", propagation.image_seeds,
           "Spread the seeds that come from the images too, not only those of other sensors.");
  list.add("form", propagation.form, {"window", "surface"},
           "Spread one disparity over a window as published, or a slanted surface.");
  list.add("window", propagation.window, 1, 101, "px", "Side of the window W_p, odd.");
  list.add("gamma", propagation.gamma, 0.1, 1000.0, "",
           "Colour difference at which the influence of a seed falls to 1/e (eq. 11).");
  list.add("reach_px", propagation.reach_px, 1.0, 1000.0, "px",
           "Form surface: way over even colour at which the influence of a seed falls to 1/e.");
  list.add("strength", propagation.strength, 0.0, 1.0, "",
           "Form surface: share of the seeds' prior in the cost of a pixel beside a trusted seed.");
  list.add("spread_px", propagation.spread_px, 0.1, 20.0, "px",
           "Form surface: how far from the surface of the seeds a disparity is still nearly free.");
}

void addQuasiDense(ParamList& list, QuasiDenseParams& p) {
  list.stage("quasi_dense");
  list.add("enabled", p.enabled,
           "Match some rows roughly first and spread what is found along surfaces; only with disparity_propagation.");
  list.add("row_step", p.row_step, 1, 16, "px", "Every so many rows are matched; smaller costs time.");
  list.add("spacing_px", p.spacing_px, 1, 64, "px", "Distance of the seeds that are taken from the rows.");
  list.add("gamma", p.gamma, 0.1, 1000.0, "", "Colour difference at which the influence of such a seed falls to 1/e.");
  list.add("reach_px", p.reach_px, 1.0, 1000.0, "px",
           "Way over even colour at which the influence of such a seed falls to 1/e.");
  list.add("strength", p.strength, 0.0, 1.0, "",
           "Share of the seeds' prior in the costs; larger fills more places without texture, and more edges suffer.");
  list.add("spread_px", p.spread_px, 0.1, 20.0, "px",
           "How far from the surface of the seeds a disparity is still nearly free.");
}

void addOptimizers(ParamList& list, PipelineParams& p) {
  const std::vector<std::string> fits = {"none", "parabola", "equiangular", "blended"};
  list.stage("optimizer");
  list.add("type", p.optimizer, {"winner_takes_all", "semi_global", "local_expansion"},
           "How costs become disparities: from the fastest to the most accurate.");
  list.stage("winner_takes_all");
  list.add("subpixel", p.winner_takes_all.subpixel, fits, "Curve through the costs around the minimum.");
  list.add("uniqueness_ratio", p.winner_takes_all.uniqueness_ratio, 0.0, 100.0, "%",
           "A pixel stays empty unless its best cost is this much below the next best.");
  list.stage("semi_global");
  list.add("p1", p.semi_global.p1, 0.0, 100.0, "cost",
           "Penalty of a disparity that changes by 1 px; larger is smoother.");
  list.add("p2", p.semi_global.p2, 0.0, 100.0, "cost",
           "Penalty of a disparity that jumps, at least p1; larger is smoother.");
  list.add("p2_gradient", p.semi_global.p2_gradient, 0.0, 10.0, "1/grey level",
           "How fast the penalty of a jump falls where the image has an edge.");
  list.add("subpixel", p.semi_global.subpixel, fits, "Curve through the costs around the minimum.");
  list.add("uniqueness_ratio", p.semi_global.uniqueness_ratio, 0.0, 100.0, "%",
           "A pixel stays empty unless its best cost is this much below the next best.", "uniqueness_ratio");
}

void addProposals(ParamList& list, const std::string& layer, PlaneProposals& p) {
  list.add(layer + "_expansions", p.expansions, 0, 100, "",
           "Planes of random pixels of a cell that one visit to a cell of the " + layer + " layer offers.");
  list.add(layer + "_ransac", p.ransac, 0, 100, "",
           "Planes fitted to a cell that one visit to a cell of the " + layer + " layer offers.");
  list.add(layer + "_random", p.random, 0, 100, "",
           "Perturbed planes that one visit to a cell of the " + layer + " layer offers.");
}

void addLocalExpansionModel(ParamList& list, LocalExpansionParams& p) {
  list.stage("local_expansion");
  list.add("lambda", p.lambda, 0.0, 100.0, "cost", "Weight of the smoothness term (eq. 3); larger is smoother.");
  list.add("tau_smooth_px", p.tau_smooth_px, 0.0, 100.0, "px",
           "Distance between neighbouring planes above which the smoothness term grows no more.");
  list.add("gamma", p.gamma, 0.1, 1000.0, "", "Colour difference at which the smoothness weight falls to 1/e.");
  list.add("epsilon", p.epsilon, 0.0, 1.0, "", "Smallest smoothness weight, across the strongest edge.");
  list.add("data_scale", p.data_scale, 0.001, 1000.0, "", "Factor of the matching cost.");
  list.add("data_threshold", p.data_threshold, 0.001, 1000.0, "cost",
           "Truncation of the matching cost after data_scale; smaller forgives occlusions, larger holds weak texture.");
  list.add("disparity_steps", p.disparity_steps, 1, 16, "1/px",
           "Costs per pixel of disparity; above 1 they are computed anew on resampled images, for sub-pixel accuracy.");
  list.add("filter_radius_px", p.filter_radius_px, 1, 50, "px", "Box radius of the guided filter of the data term.");
  list.add("filter_epsilon", p.filter_epsilon, 1e-6, 1.0, "",
           "Regularisation of the guided filter; larger smooths over colour edges.");
  list.add("margin_px", p.margin_px, 0, 50, "px", "A plane is invalid where it leaves the range within this distance.");
}

void addLocalExpansionSearch(ParamList& list, LocalExpansionParams& p) {
  list.add("initialization", p.initialization, {"random", "semi_global"}, "Where the first planes come from.");
  list.add("unary_iterations", p.unary_iterations, 0, 100, "", "First rounds that leave out the smoothness term.");
  list.add("iterations", p.iterations, 0, 100, "",
           "Rounds of expansion moves; more lower the energy a little further.");
  list.add("right_iterations", p.right_iterations, 0, 100, "",
           "The same in the right view, which serves the check alone.");
  list.add("fine_cell", p.fine_cell, 0.1, 100.0, "%", "Side of a cell of the fine layer, in percent of the width.");
  list.add("middle_cell", p.middle_cell, 0.1, 100.0, "%", "Side of a cell of the middle layer.");
  list.add("coarse_cell", p.coarse_cell, 0.1, 100.0, "%", "Side of a cell of the coarse layer.");
  list.add("seed_proposals", p.seed_proposals, "Offer the planes of the triangulated seeds to the cells in them.");
  addProposals(list, "fine", p.fine);
  addProposals(list, "middle", p.middle);
  addProposals(list, "coarse", p.coarse);
  list.add("random_first_step", p.random_first_step, 0, 20, "",
           "Random planes start within range / 2^(1 + this) of the current one; smaller searches wider.");
  list.add("ransac_threshold_px", p.ransac_threshold_px, 0.01, 100.0, "px", "Distance of an inlier to a fitted plane.");
  list.add("ransac_samples", p.ransac_samples, 1, 10000, "", "Samples of three points at most.");
  list.add("stop_gain", p.stop_gain, 0.0, 100.0, "%",
           "Stop when a round lowers the energy by less; 0 runs all rounds.");
  list.add("seed", p.seed, 0, 1000000, "", "Seed of the random numbers.");
  list.add("max_time_ms", p.max_time_ms, 0.0, 1e7, "ms",
           "Return the best planes found after this time; 0 is no limit.");
}

void addLocalExpansionRepair(ParamList& list, LocalExpansionParams& p) {
  list.add("both_views", p.both_views, "Label the right view too, check one against the other and fill by planes.");
  list.add("max_difference_px", p.max_difference_px, 0.0, 128.0, "px",
           "Largest difference between the views that counts as consistent.");
  list.add("median_radius_px", p.median_radius_px, 0, 100, "px",
           "Radius of the weighted median on filled pixels; 0 is off.");
  list.add("median_gamma", p.median_gamma, 0.1, 1000.0, "",
           "Colour difference at which a weight of that median falls to 1/e.");
}

void addPostProcessing(ParamList& list, PipelineParams& p) {
  list.stage("left_right_check");
  list.add("enabled", p.left_right_check.enabled, "Drop disparities on which the two views disagree.");
  list.add("max_difference_px", p.left_right_check.max_difference_px, 0.0, 128.0, "px",
           "Largest difference between the views' disparities that is accepted.", "disp12MaxDiff");
  list.stage("speckle_filter");
  list.add("max_size", p.speckle_filter.max_size, 0, 100000, "px", "Regions of fewer pixels are dropped; 0 is off.",
           "speckle_size");
  list.add("max_difference_px", p.speckle_filter.max_difference_px, 0.0, 128.0, "px",
           "Neighbouring disparities closer than this belong to one region.", "speckle_range");
  list.stage("hole_filling");
  list.add("enabled", p.hole_filling.enabled, "Fill pixels without disparity from the background beside them.");
  list.stage("weighted_median");
  list.add("radius", p.weighted_median.radius, 0, 50, "px", "Radius of the window of the weighted median; 0 is off.");
  list.add("gamma", p.weighted_median.gamma, 0.0, 1000.0, "",
           "Colour difference at which a neighbour's weight falls to 1/e; 0 is the plain median.");
  list.add("min_range_px", p.weighted_median.min_range_px, 0.0, 10.0, "px",
           "Smooth only where neighbouring disparities differ by more; 0 smooths everywhere.");
  list.add("only_filled", p.weighted_median.only_filled, "Smooth only the pixels that were filled.");
  list.stage("disparity_smoothing");
  list.add("radius", p.disparity_smoothing.radius, 0, 20, "px", "Reach of the edge-preserving mean; 0 is off.");
  list.add("gamma", p.disparity_smoothing.gamma, 0.1, 1000.0, "",
           "Colour difference at which a neighbour's weight is halved.");
  list.add("max_difference_px", p.disparity_smoothing.max_difference_px, 0.01, 10.0, "px",
           "Neighbours whose disparity differs by more do not count.");
}

template <typename... Fs>
struct Overloaded : Fs... {
  using Fs::operator()...;
};
template <typename... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;

std::string formatNumber(double value) {
  for (int digits = 6; digits < 17; ++digits) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << value;
    std::istringstream in(out.str());
    in.imbue(std::locale::classic());
    double back = 0.0;
    if (in >> back && back == value) return out.str();
  }
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(17);
  out << value;
  return out.str();
}

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string allowed(const ParamRef& ref) {
  if (std::holds_alternative<bool*>(ref.value)) return "true or false";
  if (const auto* choice = std::get_if<EnumRef>(&ref.value)) return "one of " + join(choice->names);
  const std::string kind = std::holds_alternative<int*>(ref.value) ? "an integer" : "a number";
  return kind + " from " + formatNumber(ref.min) + " to " + formatNumber(ref.max) +
         (ref.unit.empty() ? "" : " " + ref.unit);
}

[[noreturn]] void reject(const ParamRef& ref, const std::string& value) {
  throw std::invalid_argument(ref.key + " = '" + value + "': must be " + allowed(ref));
}

bool inRange(const ParamRef& ref, double value) { return value >= ref.min && value <= ref.max; }

bool parse(const std::string& text, bool& value) {
  value = text == "true" || text == "1" || text == "on" || text == "yes";
  return value || text == "false" || text == "0" || text == "off" || text == "no";
}

bool parse(const std::string& text, int& value) {
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

bool parse(const std::string& text, double& value) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  return !text.empty() && in >> std::noskipws >> value && in.peek() == std::istringstream::traits_type::eof();
}

int editDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

std::string nearestKey(const std::vector<ParamRef>& refs, const std::string& key) {
  const auto closer = [&](const ParamRef& a, const ParamRef& b) {
    return editDistance(a.key, key) < editDistance(b.key, key);
  };
  return std::min_element(refs.begin(), refs.end(), closer)->key;
}

const ParamRef& find(const std::vector<ParamRef>& refs, const std::string& key) {
  const auto found = std::find_if(refs.begin(), refs.end(), [&](const ParamRef& ref) { return ref.key == key; });
  if (found != refs.end()) return *found;
  throw std::invalid_argument("unknown parameter '" + key + "', did you mean '" + nearestKey(refs, key) + "'?");
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
  double weight_sum = 0.0;
  for (int i = 0; i < p.matching_cost.scales; ++i) weight_sum += p.matching_cost.scale_weights[i];
  if (weight_sum <= 0.0) throw std::invalid_argument("matching_cost.scale_weight_1 to _3: one used must be above 0");
  requireOdd("disparity_propagation.window", p.disparity_propagation.window);
  if (p.semi_global.p2 < p.semi_global.p1) {
    throw std::invalid_argument("semi_global.p2 = " + formatNumber(p.semi_global.p2) +
                                ": must be at least semi_global.p1 = " + formatNumber(p.semi_global.p1));
  }
}

/// Walks nested maps and sets each scalar; dotted keys and nesting may be mixed.
class YamlReader {
 public:
  YamlReader(PipelineParams& params, std::string name) : refs_(paramList(params)), name_(std::move(name)) {}

  void read(const YAML::Node& node, const std::string& prefix, int depth) {
    if (!node.IsMap() || depth > kMaxYamlDepth) fail(node, prefix, "must be a map of parameters");
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) fail(entry.first, prefix, "a key must be a word");
      const std::string key = prefix.empty() ? entry.first.Scalar() : prefix + "." + entry.first.Scalar();
      if (entry.second.IsScalar()) {
        set(entry.second, key);
      } else {
        read(entry.second, key, depth + 1);
      }
    }
  }

 private:
  void set(const YAML::Node& node, const std::string& key) {
    if (!seen_.insert(key).second) fail(node, key, "is given twice");
    try {
      setFromString(find(refs_, key), node.Scalar());
    } catch (const std::invalid_argument& error) {
      fail(node, "", error.what());
    }
  }

  [[noreturn]] void fail(const YAML::Node& node, const std::string& key, const std::string& problem) const {
    const int line = node.Mark().line;
    const std::string where = line >= 0 ? name_ + ":" + std::to_string(line + 1) : name_;
    throw std::invalid_argument(where + ": " + (key.empty() ? "" : key + " ") + problem);
  }

  std::vector<ParamRef> refs_;
  std::string name_;
  std::set<std::string> seen_;
};

std::string readText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::invalid_argument(path + ": cannot be read");
  std::string text(kMaxYamlBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || (!file.eof() && file.fail())) throw std::invalid_argument(path + ": cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
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
  addLocalExpansionModel(list, params.local_expansion);
  addLocalExpansionSearch(list, params.local_expansion);
  addLocalExpansionRepair(list, params.local_expansion);
  addPostProcessing(list, params);
  return list.take();
}

std::string toString(const ParamRef& ref) {
  return std::visit(Overloaded{[](const bool* value) { return std::string(*value ? "true" : "false"); },
                               [](const int* value) { return std::to_string(*value); },
                               [](const double* value) { return formatNumber(*value); },
                               [](const EnumRef& choice) { return choice.names.at(choice.get()); }},
                    ref.value);
}

void setFromString(const ParamRef& ref, const std::string& text) {
  const auto setNumber = [&](auto* target) {
    auto value = *target;
    if (!parse(text, value)) reject(ref, text);
    if (!inRange(ref, static_cast<double>(value))) reject(ref, text);
    *target = value;
  };
  const auto setChoice = [&](const EnumRef& choice) {
    const auto found = std::find(choice.names.begin(), choice.names.end(), text);
    if (found == choice.names.end()) reject(ref, text);
    choice.set(static_cast<int>(found - choice.names.begin()));
  };
  std::visit(Overloaded{[&](auto* target) { setNumber(target); }, setChoice}, ref.value);
}

void setParam(PipelineParams& params, const std::string& key, const std::string& text) {
  setFromString(find(paramList(params), key), text);
}

void setParam(PipelineParams& params, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) throw std::invalid_argument("'" + assignment + "': must be stage.name=value");
  setParam(params, assignment.substr(0, equals), assignment.substr(equals + 1));
}

void validate(const PipelineParams& params) {
  PipelineParams copy = params;
  for (const ParamRef& ref : paramList(copy)) {
    const double value = std::visit(Overloaded{[](const EnumRef& choice) { return static_cast<double>(choice.get()); },
                                               [](const auto* number) { return static_cast<double>(*number); }},
                                    ref.value);
    if (!inRange(ref, value)) reject(ref, formatNumber(value));
  }
  validateTogether(params);
}

void loadYaml(PipelineParams& params, const std::string& text, const std::string& name) {
  if (text.size() > kMaxYamlBytes) throw std::invalid_argument(name + ": more than 1 MB cannot be parameters");
  PipelineParams loaded = params;
  try {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsNull()) YamlReader(loaded, name).read(root, "", 0);
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(name + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
  params = loaded;
}

std::string toYaml(const PipelineParams& params) {
  PipelineParams copy = params;
  std::string yaml;
  std::string stage;
  for (const ParamRef& ref : paramList(copy)) {
    const std::size_t dot = ref.key.find('.');
    if (ref.key.substr(0, dot) != stage) {
      stage = ref.key.substr(0, dot);
      yaml += stage + ":\n";
    }
    yaml += "  " + ref.key.substr(dot + 1) + ": " + toString(ref) + "\n";
  }
  return yaml;
}

std::vector<std::string> presetNames() {
  std::vector<std::string> names;
  for (const Preset& preset : builtInPresets()) names.push_back(preset.name);
  return names;
}

PipelineParams loadPreset(const std::string& name_or_file) {
  PipelineParams params;
  for (const Preset& preset : builtInPresets()) {
    if (preset.name == name_or_file) {
      loadYaml(params, preset.yaml, "preset " + preset.name);
      return params;
    }
  }
  if (name_or_file.find_first_of("/.") == std::string::npos) {
    throw std::invalid_argument("unknown preset '" + name_or_file + "': there are " + join(presetNames()) +
                                ", or give a YAML file");
  }
  loadYaml(params, readText(name_or_file), name_or_file);
  return params;
}

}  // namespace fdp_stereo
