#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "errors.hpp"
#include "keywords.hpp"
#include "module.hpp"
#include "pingvox/sonar/detect_echo.hpp"
#include "pingvox/sonar/filters.hpp"
#include "pingvox/sonar/polar_image.hpp"
#include "pingvox/sonar/sweep.hpp"
#include "recorded_beams.hpp"

namespace pingvox::python {
namespace {

/// One beam of several, which it keeps alive.
struct BeamView {
  std::shared_ptr<const Beam> beam;
};

/// A sweep with its image.
struct SweepView {
  Sweep sweep;
  PolarImage image;

  explicit SweepView(Sweep of) : sweep(std::move(of)), image(sweep) {}
};

/// Echoes, one for each beam.
struct Echoes {
  py::array found, ranges, intensities, first, peak, last, thresholds;
};

class EchoColumns {
 public:
  void add(const std::optional<Echo>& echo) {
    found_.push_back(echo ? 1 : 0);
    ranges_.push_back(echo ? echo->range_m : std::numeric_limits<double>::quiet_NaN());
    intensities_.push_back(echo ? echo->intensity : std::uint8_t{0});
    first_.push_back(echo ? static_cast<std::int64_t>(echo->first) : -1);
    peak_.push_back(echo ? static_cast<std::int64_t>(echo->peak) : -1);
    last_.push_back(echo ? static_cast<std::int64_t>(echo->last) : -1);
    thresholds_.push_back(echo ? echo->threshold : 0);
  }
  Echoes take() {
    return {array_of(std::move(found_)).attr("astype")("bool"),
            array_of(std::move(ranges_)),
            array_of(std::move(intensities_)),
            array_of(std::move(first_)),
            array_of(std::move(peak_)),
            array_of(std::move(last_)),
            array_of(std::move(thresholds_))};
  }

 private:
  std::vector<std::uint8_t> found_, intensities_;
  std::vector<double> ranges_;
  std::vector<std::int64_t> first_, peak_, last_;
  std::vector<int> thresholds_;
};

RecordedBeams beams_of(const py::object& time_values, const py::object& bearing_values, double bin_length,
                       const py::object& intensity_values, const std::optional<std::vector<std::size_t>>& bins) {
  const DoubleArray times = double_array(time_values, "times", "(N,)");
  const DoubleArray bearings = double_array(bearing_values, "bearings", "(N,)");
  const ByteArray intensities = byte_array(intensity_values, "intensities", "(N, bins)");
  if (times.ndim() != 1 || bearings.ndim() != 1 || intensities.ndim() != 2 || bearings.size() != times.size() ||
      intensities.shape(0) != times.size() || (bins && bins->size() != size_of(times, 0))) {
    raise_usage("Beams: times, bearings and bins must have the shape (N,), intensities (N, bins)");
  }
  std::vector<Beam> beams;
  const std::size_t columns = size_of(intensities, 1);
  for (std::size_t i = 0; i < size_of(times, 0); ++i) {
    const std::uint8_t* const row = intensities.data() + i * columns;
    const std::size_t size = bins ? (*bins)[i] : columns;
    if (size > columns) raise_usage(fmt::format("bins[{}]: must be at most {}, is {}", i, columns, size));
    Beam beam{times.data()[i], bearings.data()[i], bin_length, {row, row + size}};
    if (std::isfinite(beam.bearing_rad)) beam.bearing_rad = wrap_bearing(beam.bearing_rad);
    if (const auto valid = validate(beam); !valid)
      raise_usage(fmt::format("Beams: beam {}: {}", i, valid.error().message));
    beams.push_back(std::move(beam));
  }
  return RecordedBeams(std::move(beams));
}

template <class Number>
py::array column_of(const RecordedBeams& recorded, Number Beam::* field) {
  std::vector<Number> values;
  for (const Beam& beam : *recorded.beams) values.push_back(beam.*field);
  return array_of(std::move(values));
}

py::array bins_of(const RecordedBeams& recorded) {
  std::vector<std::int64_t> bins;
  for (const Beam& beam : *recorded.beams) bins.push_back(static_cast<std::int64_t>(beam.intensities.size()));
  return array_of(std::move(bins));
}

py::array intensities_of(const RecordedBeams& recorded) {
  std::size_t columns = 0;
  for (const Beam& beam : *recorded.beams) columns = std::max(columns, beam.intensities.size());
  const std::size_t rows = recorded.beams->size();
  std::vector<std::uint8_t> all(rows * columns);
  for (std::size_t i = 0; i < rows; ++i) {
    const auto offset = static_cast<std::ptrdiff_t>(i * columns);
    std::ranges::copy((*recorded.beams)[i].intensities, all.begin() + offset);
  }
  return array_of(std::move(all), {static_cast<py::ssize_t>(rows), static_cast<py::ssize_t>(columns)});
}

BeamView beam_at(const RecordedBeams& recorded, std::ptrdiff_t index) {
  const auto size = static_cast<std::ptrdiff_t>(recorded.beams->size());
  const std::ptrdiff_t from_start = index < 0 ? index + size : index;
  if (from_start < 0 || from_start >= size) throw py::index_error(fmt::format("there are {} beams", size));
  return {{recorded.beams, &(*recorded.beams)[static_cast<std::size_t>(from_start)]}};
}

RecordedBeams beams_at(const RecordedBeams& recorded, const py::slice& which) {
  py::ssize_t start = 0, stop = 0, step = 0, count = 0;
  const auto size = static_cast<py::ssize_t>(recorded.beams->size());
  if (!which.compute(size, &start, &stop, &step, &count)) throw py::error_already_set();
  std::vector<Beam> beams;
  for (py::ssize_t i = 0; i < count; ++i) {
    beams.push_back((*recorded.beams)[static_cast<std::size_t>(start + i * step)]);
  }
  RecordedBeams some(std::move(beams));
  some.note = recorded.note;
  return some;
}

std::vector<std::shared_ptr<SweepView>> sweeps_in(const RecordedBeams& recorded) {
  return without_lock([&] {
    std::vector<std::shared_ptr<SweepView>> views;
    for (Sweep& sweep : sweeps_of(*recorded.beams)) views.push_back(std::make_shared<SweepView>(std::move(sweep)));
    return views;
  });
}

Echoes echoes_in(const RecordedBeams& recorded, const py::kwargs& keywords) {
  const EchoKeywords options = echo_options(keywords);
  EchoColumns columns;
  without_lock([&] {
    Interpreter interpreter;
    for (const Sweep& sweep : sweeps_of(*recorded.beams)) {
      const PolarImage image = apply_filter(PolarImage(sweep), options.filter);
      for (const auto& echo : detect_echoes(image, sweep, options.echo)) columns.add(echo);
      if (interpreter.is_due()) interpreter.tell(0);
    }
  });
  return columns.take();
}

Echoes echoes_of(const SweepView& view, const py::kwargs& keywords) {
  const EchoKeywords options = echo_options(keywords);
  EchoColumns columns;
  without_lock([&] {
    const PolarImage image = apply_filter(view.image, options.filter);
    for (const auto& echo : detect_echoes(image, view.sweep, options.echo)) columns.add(echo);
  });
  return columns.take();
}

/// All rows of an image as an array, which owns it.
py::array array_of_image(PolarImage image) {
  if (image.rows() == 0 || image.columns() == 0) return py::array_t<std::uint8_t>(std::vector<py::ssize_t>{0, 0});
  auto held = std::make_unique<PolarImage>(std::move(image));
  PolarImage& kept = *held;
  const py::capsule owner(held.get(), [](void* pointer) { delete static_cast<PolarImage*>(pointer); });
  static_cast<void>(held.release());
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(kept.rows()),
                                          static_cast<py::ssize_t>(kept.columns())};
  return py::array_t<std::uint8_t>(shape, kept.row(0).data(), owner);
}

py::array image_of(const py::object& self) {
  const auto& view = self.cast<const SweepView&>();
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(view.image.rows()),
                                          static_cast<py::ssize_t>(view.image.columns())};
  return view_of(view.image.row(0).data(), shape, self);
}

py::array filter_image(const py::object& values, bool wrap, const py::kwargs& keywords) {
  const FilterOptions options = filter_options(keywords);
  const ByteArray pixels = byte_array(values, "image", "(beams, bins)");
  if (pixels.ndim() != 2) raise_usage("image: must be an array of shape (beams, bins)");
  const std::size_t rows = size_of(pixels, 0), columns = size_of(pixels, 1);
  PolarImage image(std::vector<std::size_t>(rows, columns), columns,
                   wrap ? PolarImage::Wrap::kAround : PolarImage::Wrap::kNone);
  for (std::size_t n = 0; n < rows; ++n) std::copy_n(pixels.data() + n * columns, columns, image.row(n).begin());
  return array_of_image(without_lock([&] { return apply_filter(image, options); }));
}

std::string name_of(Sweep::Extent extent) {
  if (extent == Sweep::Extent::kTurn) return "turn";
  return extent == Sweep::Extent::kSector ? "sector" : "cut";
}

void bind_sweep(py::module_& module) {
  const std::string echo_doc =
      docstring("The first echo of each beam, after filtering; beams without one have found = False.", "Sweep.echoes");
  py::class_<SweepView, std::shared_ptr<SweepView>>(
      module, "Sweep", "The beams of one turn of the head, or of one pass over its sector, as a polar image.")
      .def_property_readonly(
          "extent", [](const SweepView& view) { return name_of(view.sweep.extent); },
          "'turn', 'sector' or 'cut' (not complete).")
      .def_property_readonly("image", &image_of,
                             "(beams, bins) uint8: the memory of the sweep, read only; shorter beams end with 0.")
      .def(
          "beams", [](const SweepView& view) { return RecordedBeams(view.sweep.beams); }, "Its beams, copied.")
      .def(
          "filtered",
          [](const SweepView& view, const py::kwargs& keywords) {
            const FilterOptions options = filter_options(keywords);
            return array_of_image(without_lock([&] { return apply_filter(view.image, options); }));
          },
          docstring("The image, smoothed: (beams, bins) uint8.", "filter_image").c_str())
      .def("echoes", &echoes_of, echo_doc.c_str())
      .def("__len__", [](const SweepView& view) { return view.sweep.beams.size(); })
      .def("__repr__", [](const SweepView& view) {
        return fmt::format("<pingvox.Sweep of {} beams, {}>", view.sweep.beams.size(), name_of(view.sweep.extent));
      });
}

}  // namespace

void bind_beams(py::module_& module) {
  // First, so that signatures of the others name it.
  py::class_<RecordedBeams> beams_class(module, "Beams", "Beams in order of recording.");
  py::class_<Echoes>(module, "Echoes", "The first echo of each beam, an entry for each beam.")
      .def_readonly("found", &Echoes::found, "(N,) bool: whether the beam has one.")
      .def_readonly("ranges", &Echoes::ranges, "(N,) float64, metres from the transducer; NaN: none.")
      .def_readonly("intensities", &Echoes::intensities, "(N,) uint8, of the peak after filtering; 0: none.")
      .def_readonly("first", &Echoes::first, "(N,) int64, the bin where it was detected; -1: none.")
      .def_readonly("peak", &Echoes::peak, "(N,) int64, its strongest bin; -1: none.")
      .def_readonly("last", &Echoes::last, "(N,) int64, its last bin; -1: none.")
      .def_readonly("thresholds", &Echoes::thresholds, "(N,) int32, that detected it; 0: none.")
      .def("__len__", [](const Echoes& echoes) { return py::len(echoes.ranges); })
      .def("__repr__", [](const Echoes& echoes) {
        return fmt::format("<pingvox.Echoes of {} beams, {} found>", py::len(echoes.ranges),
                           echoes.found.attr("sum")().cast<std::size_t>());
      });
  py::class_<BeamView>(module, "Beam", "What the sonar received from one ping in one direction.")
      .def_property_readonly(
          "time", [](const BeamView& view) { return view.beam->time_s; }, "Seconds on the log's own clock.")
      .def_property_readonly(
          "bearing", [](const BeamView& view) { return view.beam->bearing_rad; },
          "Radians, 0 ahead, counter-clockwise seen from above, in [0, 2 pi).")
      .def_property_readonly(
          "bin_length", [](const BeamView& view) { return view.beam->bin_length_m; }, "Metres.")
      .def_property_readonly(
          "intensities",
          [](const py::object& self) {
            const Beam& beam = *self.cast<const BeamView&>().beam;
            return view_of(beam.intensities.data(), {static_cast<py::ssize_t>(beam.intensities.size())}, self);
          },
          "(bins,) uint8: the memory of the beam, read only. Bin i covers [i, i + 1) * bin_length.")
      .def("__repr__", [](const BeamView& view) {
        return fmt::format("<pingvox.Beam at {:.3f} s, {:.3f} rad, {} bins of {:.6g} m>", view.beam->time_s,
                           view.beam->bearing_rad, view.beam->intensities.size(), view.beam->bin_length_m);
      });
  bind_sweep(module);
  const std::string echo_doc =
      docstring("The first echo of each beam, sweep by sweep. Returns Echoes of as many entries as there are beams.",
                "Beams.echoes");
  beams_class
      .def(py::init(&beams_of), py::arg("times"), py::arg("bearings"), py::arg("bin_length"), py::arg("intensities"),
           py::arg("bins") = py::none(),
           "times: (N,) seconds; bearings: (N,) radians, counter-clockwise from ahead; bin_length: metres;\n"
           "intensities: (N, bins) whole numbers in 0..255; bins: how many of each row count, (N,), all by default.")
      .def_property_readonly(
          "times", [](const RecordedBeams& beams) { return column_of(beams, &Beam::time_s); },
          "(N,) float64, seconds on the log's own clock.")
      .def_property_readonly(
          "bearings", [](const RecordedBeams& beams) { return column_of(beams, &Beam::bearing_rad); },
          "(N,) float64, radians, 0 ahead, counter-clockwise, in [0, 2 pi).")
      .def_property_readonly(
          "bin_lengths", [](const RecordedBeams& beams) { return column_of(beams, &Beam::bin_length_m); },
          "(N,) float64, metres.")
      .def_property_readonly("bins", &bins_of, "(N,) int64: how many each beam has.")
      .def_property_readonly("intensities", &intensities_of,
                             "(N, bins) uint8, a new array; shorter beams end with 0. beams[i].intensities and\n"
                             "Sweep.image copy nothing.")
      .def_property_readonly(
          "skipped", [](const RecordedBeams& beams) { return beams.skipped; }, "Records of the log that were damaged.")
      .def_property_readonly(
          "note", [](const RecordedBeams& beams) { return beams.note; },
          "How the log was read where it is not as its format says; empty: as it says.")
      .def("sweeps", &sweeps_in, "Its sweeps; the beams left over at the end are the last one.")
      .def("echoes", &echoes_in, echo_doc.c_str())
      .def("__getitem__", &beam_at, py::arg("index"))
      .def("__getitem__", &beams_at, py::arg("index"), "Some of them, copied.")
      .def("__iter__",
           [](const py::object& self) { return py::reinterpret_steal<py::object>(PySeqIter_New(self.ptr())); })
      .def("__len__", [](const RecordedBeams& beams) { return beams.beams->size(); })
      .def("__repr__",
           [](const RecordedBeams& beams) { return fmt::format("<pingvox.Beams, {}>", beams.beams->size()); });
  module.def("filter_image", &filter_image, py::arg("image"), py::arg("wrap") = true,
             docstring("Smooths a polar image.\n\nimage: (beams, bins) whole numbers in 0..255; wrap: whether the last "
                       "beam is a neighbour "
                       "of the first.\nReturns an array of the same shape.",
                       "filter_image")
                 .c_str());
}

}  // namespace pingvox::python
