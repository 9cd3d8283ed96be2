#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "services/messages/message.h"

namespace rgbdt::testing {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Valid messages with random contents, repeatable by seed.
class RandomMessages {
 public:
  explicit RandomMessages(std::uint64_t seed) : engine_(seed) {}

  int Int(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  double Number(double low = -100, double high = 100) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  bool Coin() { return Int(0, 1) == 1; }
  Utime Time() { return 1'600'000'000'000'000 + Int(0, 1'000'000'000); }
  std::int64_t Seq() { return Int(0, 1'000'000'000); }

  std::string Name() {
    static const char* const kNames[] = {"rgb", "thermal", "left_2", "c"};
    return kNames[Int(0, 3)];
  }
  std::string Text() {
    static const char* const kTexts[] = {"", "no board in view", "two\nlines\t",
                                         "\xc3\xa4 \xe2\x82\xac"};
    return kTexts[Int(0, 3)];
  }
  float NumberOrNan(double low, double high) {
    return Int(0, 4) == 0 ? kNan : static_cast<float>(Number(low, high));
  }
  std::vector<float> Numbers(int size, double low, double high) {
    std::vector<float> values(static_cast<std::size_t>(size));
    for (float& value : values) value = NumberOrNan(low, high);
    return values;
  }
  template <typename Row>
  std::vector<Row> Rows(int size, double low = -10, double high = 3000) {
    std::vector<Row> rows(static_cast<std::size_t>(size));
    for (Row& row : rows) {
      for (Eigen::Index i = 0; i < row.size(); ++i) {
        row[i] = static_cast<typename Row::Scalar>(Number(low, high));
      }
    }
    return rows;
  }
  Eigen::Vector3d Unit() { return (Rows<Eigen::Vector3d>(1, 0.1, 1)[0]).normalized(); }
  Rigid3 Rigid() {
    const Eigen::Vector4d q = Rows<Eigen::Vector4d>(1, 0.1, 1)[0].normalized();
    return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(), Rows<Eigen::Vector3d>(1)[0]};
  }

  template <int N>
  Eigen::Matrix<double, N, N> Covariance() {
    using Matrix = Eigen::Matrix<double, N, N>;
    const Matrix root = Matrix::NullaryExpr([&] { return Number(-0.01, 0.01); });
    return root * root.transpose();
  }

  LineScan Line() {
    LineScan line;
    line.utime = Time();
    line.seq = Seq();
    line.beam_period_s = Number(0, 0.1);
    line.first_angle_rad = Number(-3, 3);
    line.angle_step_rad = Number(-0.1, 0.1);
    const int beams = Int(0, 50);
    line.range = Numbers(beams, 0.1, 100);
    line.intensity = Numbers(beams, 0, 1);
    return line;
  }

  EncoderReading Encoder() { return {Time(), Seq(), Int(-100000, 100000), Coin() ? Time() : 0}; }

  Image Picture(PixelFormat format) {
    Image image;
    image.camera = Name();
    image.utime = Time();
    image.seq = Seq();
    image.frame_number = Seq();
    image.device_utime = Seq();
    image.exposure_s = Number(0, 1);
    image.format = format;
    image.shutter_correcting = Coin();
    const int type = format == PixelFormat::kMono16 ? CV_16UC1
                     : format == PixelFormat::kBgr8 ? CV_8UC3
                                                    : CV_8UC1;
    image.pixels.create(Int(1, 20), Int(1, 30), type);
    for (int row = 0; row < image.pixels.rows; ++row) {
      std::uint8_t* p = image.pixels.ptr(row);
      const auto bytes = static_cast<std::size_t>(image.pixels.cols) * image.pixels.elemSize();
      for (std::size_t i = 0; i < bytes; ++i) p[i] = static_cast<std::uint8_t>(Int(0, 255));
    }
    image.radiometry.kind = static_cast<Radiometry::Kind>(Int(0, 2));
    if (image.radiometry.kind != Radiometry::Kind::kNone) {
      Radiometry& r = image.radiometry;
      r.gain = 0.04, r.offset = Number(), r.r = 15000, r.b = 1400, r.f = 1.1, r.o = Number();
      r.emissivity = Number(0.1, 1);
      r.reflected_temperature_k = Number(0, 300);
    }
    return image;
  }
  Image Picture() { return Picture(static_cast<PixelFormat>(Int(1, 7))); }

  /// As a sensor sends it that gives everything.
  CloudChunk Chunk(int lines, int beams) {
    CloudChunk chunk;
    chunk.seq = Seq();
    chunk.sweep_end = Coin();
    chunk.sweep_lines = Int(0, 500);
    chunk.lines_lost = Int(0, 5);
    Cloud& cloud = chunk.cloud;
    cloud.sweep_utime = Time();
    cloud.first_line = Int(0, 400);
    cloud.lines = lines;
    cloud.beams = beams;
    cloud.organised = lines > 1 || Coin();
    cloud.origins = Rows<Eigen::Vector3f>(Coin() ? lines : 0, -1, 1);
    const Utime start = Time();
    for (int i = 0; i < lines * beams; ++i) {
      const Eigen::Vector3f direction = Unit().cast<float>();
      const Eigen::Vector3f origin = cloud.origins.empty()
                                         ? Eigen::Vector3f(0, 0, 0)
                                         : cloud.origins[static_cast<std::size_t>(i / beams)];
      const bool hit = Int(0, 2) != 0;
      cloud.points.push_back(hit ? Eigen::Vector3f(origin + Number(1, 50) * direction)
                                 : Eigen::Vector3f::Constant(kNan));
      cloud.directions.push_back(direction);
      cloud.intensity.push_back(NumberOrNan(0, 1));
      cloud.utime.push_back(start + 100 * i);
      cloud.ring.push_back(static_cast<std::uint16_t>(beams > 0 ? i % beams : 0));
    }
    return chunk;
  }
  CloudChunk Chunk() {
    const int lines = Int(0, 4);
    return Chunk(lines, lines > 0 ? Int(1, 30) : 0);
  }

  CornerSelection Corners() {
    CornerSelection selection;
    selection.camera = Name();
    selection.utime = Time();
    selection.image_utime = Time();
    selection.seq = Seq();
    for (Eigen::Vector2d& corner : selection.corners) corner = Rows<Eigen::Vector2d>(1)[0];
    return selection;
  }

  ImageDetection InImage() {
    ImageDetection image;
    image.camera = Name();
    image.utime = Time();
    image.detect_s = Number(0, 3);
    if (Int(0, 3) != 0) image.edges = Edges();
    if (!image.edges || Int(0, 3) == 0) image.why_not = "no board in view";
    return image;
  }

  ViewDetection Seen() {
    ViewDetection detection;
    detection.view = "00" + std::to_string(Int(10, 99));
    detection.seq = Seq();
    detection.sweep_utime = Time();
    detection.heldout = Coin();
    for (int i = Int(0, 3); i > 0; --i) detection.images.push_back(InImage());
    for (int i = Int(0, 3); i > 0; --i) {
      detection.cloud.candidates.push_back(Boundary());
      if (Coin()) detection.cloud.candidates.back().camera = Name();
    }
    if (detection.cloud.candidates.empty()) detection.cloud.why_not = "no board in the cloud";
    detection.cloud.detect_s = Number(0, 3);
    return detection;
  }
  TargetPose PoseOfTarget() { return {Rigid(), Covariance<6>(), Coin()}; }
  ImageSide Side() {
    ImageSide side;
    side.seen = Coin();
    side.why = side.seen ? "" : Text();
    side.curve = Rows<Eigen::Vector2d>(side.seen ? Int(2, 20) : Int(0, 20));
    side.covariance = Covariance<2>();
    return side;
  }
  Crossing WhereAScanLeaves() {
    return {Rows<Eigen::Vector3d>(1)[0], Number(0, 0.1), Int(0, 3),
            static_cast<CrossingKind>(Int(1, 3)), Number(0, 0.1)};
  }
  Eigen::Matrix4d Scatter() {
    Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
    for (const Eigen::Vector3d& point : Rows<Eigen::Vector3d>(Int(0, 20), -1, 1)) {
      const Eigen::Vector4d q = point.homogeneous();
      scatter += q * q.transpose();
    }
    return scatter;
  }
  PointGroup Group() { return {Int(-1, 127), Number(-16, 0), Scatter()}; }
  ImageEdges Edges() {
    ImageEdges image;
    image.width = Int(100, 20000);
    image.height = Int(100, 20000);
    image.corners = Rows<Eigen::Vector2d>(Int(0, 70));
    for (Eigen::Vector2d& corner : image.outline_corners) corner = Rows<Eigen::Vector2d>(1)[0];
    image.picked = Coin();
    image.edge_pixels = Rows<Eigen::Vector2i>(Int(0, 300), 0, 99);
    image.outline = Rows<Eigen::Vector2d>(Int(0, 80));
    image.corner_sigma_px = Number(0, 1);
    if (Coin()) image.pose = PoseOfTarget();
    for (ImageSide& side : image.sides) side = Side();
    return image;
  }
  CloudEdges Boundary() {
    CloudEdges cloud;
    cloud.boundary = Rows<Eigen::Vector3d>(Int(0, 100));
    cloud.centre = Rows<Eigen::Vector3d>(1)[0];
    cloud.normal = Unit();
    cloud.width_m = Number(1, 2);
    cloud.height_m = Number(0, 1);
    cloud.spacing_m = Number(0, 0.1);
    cloud.points = Int(0, 10000);
    if (Coin()) cloud.pose = PoseOfTarget();
    for (int i = Int(0, 20); i > 0; --i) cloud.crossings.push_back(WhereAScanLeaves());
    cloud.scatter = Scatter();
    cloud.raw_scatter = Scatter();
    cloud.scatter_sigma_m = Number(0, 0.1);
    for (int i = Int(0, 9); i > 0; --i) cloud.groups.push_back(Group());
    cloud.group_sigma_m = Number(0, 0.1);
    cloud.turn_rad_s = Number(-1, 1);
    return cloud;
  }

  SolvedLens AnyLens() {
    SolvedLens solved;
    solved.lens = {Lens::Model::kFisheye, 400, 401, Number(), Number(), {}};
    for (double& k : solved.lens.distortion) k = Number();
    for (Eigen::Index i = 0; i < 6; ++i) solved.covariance.col(i).setConstant(Number());
    solved.covariance.rightCols<kLensNumbers>() = Covariance<kLensNumbers>();
    return solved;
  }

  RangeErrors AnyRangeErrors() {
    const auto estimate = [this] { return Estimate{Number(-0.1, 0.1), Number(0, 0.1)}; };
    RangeErrors errors;
    errors.offset_m = estimate();
    errors.beams_meet_m = estimate();
    for (int ring = Int(0, 200); ring <= 255; ring += Int(1, 50)) {
      errors.rings.push_back({ring, estimate()});
    }
    for (double log2 = Number(-16, 1); log2 <= 0; ++log2) {
      errors.intensities.push_back({log2, estimate()});
    }
    return errors;
  }

  CalibrationMessage Calibrated() {
    CalibrationMessage message;
    message.seq = Seq();
    message.utime = Time();
    message.rig_hash = "3f9a";
    message.method = "paper";
    message.calibration.camera = Name();
    message.calibration.camera_from_lidar = Rigid();
    message.calibration.status = static_cast<SolveStatus>(Int(0, 5));
    message.calibration.detail = Text();
    if (Coin()) message.calibration.covariance = Covariance<6>();
    if (Coin()) message.calibration.lens = AnyLens();
    if (Coin()) message.calibration.range_errors = AnyRangeErrors();
    if (Coin()) message.calibration.timing = CameraTiming{{-0.25, 1e-4}, {0.02, 3e-5}};
    return message;
  }

  RgbdtCloud Fused() {
    RgbdtCloud cloud;
    cloud.seq = Seq();
    cloud.sweep_utime = Time();
    cloud.sweep_end = Coin();
    cloud.cameras = {"rgb", "thermal"};
    cloud.whole_sweep = Coin();
    for (int i = 0; i < 2; ++i) cloud.calibration_utime.push_back(Coin() ? Time() : 0);
    if (Coin()) {
      cloud.map_from_lidar = Rigid();
      cloud.frame_utime = Time();
    }
    const int size = Int(0, 100);
    cloud.points = Rows<Eigen::Vector3f>(size, -50, 50);
    cloud.intensity = Numbers(size, 0, 1);
    cloud.temperature_k = Numbers(size, 200, 400);
    cloud.temperature_sigma_k = Numbers(size, 0, 5);
    cloud.thermal_counts = Numbers(size, 0, 16383);
    const Utime start = Time();
    for (int i = 0; i < size; ++i) {
      cloud.utime.push_back(start + Int(0, 1000));
      cloud.rgb.push_back(
          {static_cast<std::uint8_t>(Int(0, 255)), static_cast<std::uint8_t>(Int(0, 255)), 255});
      cloud.valid.push_back(static_cast<std::uint32_t>(Int(0, 3)));
    }
    return cloud;
  }

  StampedPose Pose() { return {Seq(), Time(), "gps_ins", Rigid()}; }
  RigText RigFile() { return {Seq(), "3f9a", "name: \"rig\"\n" + Text()}; }
  SessionCommand Command() {
    SessionCommand command;
    command.command = Int(0, 1000);
    command.seq = Seq();
    command.utime = Coin() ? Time() : 0;
    command.verb = static_cast<SessionVerb>(Int(1, 8));
    command.view = Coin() ? "0001" : "";
    command.sweep_utime = Coin() ? Time() : 0;
    command.heldout = Coin();
    for (int i = Int(0, 3); i > 0; --i) command.picked_cameras.push_back(Name());
    return command;
  }
  SessionEvent Event() {
    return {Int(0, 1000), Seq(),  Time(),      "simulator", static_cast<EventKind>(Int(1, 3)),
            Text(),       Time(), Number(0, 1)};
  }
  Status Health() {
    Status status{"assembler", Seq(), Time(), Coin(), Text(), Text(), {}};
    for (int i = Int(0, 4); i > 0; --i) {
      status.counters.emplace_back("dropped CLOUD", Int(-5, 1'000'000));
    }
    return status;
  }
  SessionRequest Request() {
    return {Seq(), Time(), static_cast<SessionRequestKind>(Int(1, 4)), Coin()};
  }
  LeftOutViews LeftOut() {
    LeftOutViews left_out;
    left_out.seq = Seq();
    left_out.utime = Time();
    for (int i = Int(0, 5); i > 0; --i) left_out.views.push_back(Name());
    return left_out;
  }
  TargetStatus TargetSeen() {
    TargetStatus status;
    status.seq = Seq();
    status.utime = Time();
    if (Coin()) status.camera = Name();
    status.seen = Coin();
    status.text = Text();
    status.corners = Rows<Eigen::Vector2d>(Int(0, 20));
    status.outline = Rows<Eigen::Vector2d>(Int(0, 20));
    status.centre = Rows<Eigen::Vector3d>(1)[0];
    return status;
  }
  MountCheck Watched() {
    MountCheck check;
    check.seq = Seq();
    check.utime = Time();
    check.camera = Name();
    check.calibration_utime = Time();
    check.sweeps = static_cast<int>(Int(0, 20));
    check.state = static_cast<MountState>(Int(1, 4));
    if (Coin()) check.holds = 0.125;
    check.camera_from_lidar = Pose().map_from_lidar;
    check.moved = Vector6d::LinSpaced(-0.25, 0.5);
    check.covariance = Matrix6d(Vector6d::Constant(0.5).asDiagonal());
    check.told = {0, 0.25, 0.5, 0.75, 1, 0.125};
    check.edges = 250;
    check.shown = 0.5;
    check.where[3] = 0.75;
    check.where[8] = 0.25;
    check.text = Text();
    return check;
  }
  SweepOdometry Odometry() {
    SweepOdometry odometry;
    odometry.seq = Seq();
    odometry.utime = Time();
    odometry.placed = Coin();
    odometry.begun_anew = Coin();
    odometry.map_from_lidar = Pose().map_from_lidar;
    odometry.velocity = Vector6d::LinSpaced(-0.5, 0.75);
    odometry.covariance = Matrix6d(Vector6d::Constant(0.25).asDiagonal());
    for (auto i = Int(0, 3); i > 0; --i) odometry.untold.push_back(Text());
    odometry.residual_m = 0.0625;
    odometry.text = Text();
    return odometry;
  }
  WaveProgress Waving() {
    WaveProgress progress;
    progress.seq = Seq();
    progress.utime = Time();
    progress.phase = static_cast<WavePhase>(Int(1, 5));
    progress.left_s = 12.5;
    progress.text = Text();
    for (int i = 0; i < Int(0, 3); ++i) {
      WavedClock& clock = progress.clocks.emplace_back();
      clock.camera = Name();
      if (Coin()) clock.time_offset_s = {-0.0125, 0.0005};
      clock.text = Text();
    }
    return progress;
  }
  ReportText Report() { return {Seq(), Time(), "{\"method\": \"paper\"}"}; }

  /// One of every alternative.
  Messages OneOfEach() {
    return {Line(),       Encoder(), Picture(), Chunk(),   Corners(), Seen(),    Calibrated(),
            Fused(),      Pose(),    RigFile(), Command(), Event(),   Request(), LeftOut(),
            TargetSeen(), Watched(), Waving(),  Health(),  Report(),  Odometry()};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace rgbdt::testing
