#include "calib/simulate/internal/ray_caster.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace rgbdt::simulate {
namespace {

/// How many rays are traced at once.
constexpr int kPacket = 8;

RTCRay MakeRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double range) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = 0;
  ray.tfar = static_cast<float>(range);
  ray.mask = 0xffffffffU;
  return ray;
}

}  // namespace

struct RayCaster::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Mesh> meshes;

  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void AddMesh(const Mesh& mesh);
  Eigen::Vector3d SmoothNormal(const RTCHit& hit) const;
};

void RayCaster::Impl::AddMesh(const Mesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), mesh.triangles.size()));
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw std::runtime_error("Embree: no memory for a mesh");
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (int k = 0; k < 3; ++k) vertices[3 * i + k] = static_cast<float>(mesh.vertices[i][k]);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) indices[3 * i + k] = mesh.triangles[i][k];
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);  // numbered 0, 1, ... in the order of attaching
  rtcReleaseGeometry(geometry);
}

Eigen::Vector3d RayCaster::Impl::SmoothNormal(const RTCHit& hit) const {
  const Mesh& mesh = meshes[hit.geomID];
  if (!mesh.round()) return {hit.Ng_x, hit.Ng_y, hit.Ng_z};
  const std::array<unsigned, 3>& t = mesh.triangles[hit.primID];
  return (1.0 - hit.u - hit.v) * mesh.normals[t[0]] + double(hit.u) * mesh.normals[t[1]] +
         double(hit.v) * mesh.normals[t[2]];
}

RayCaster::RayCaster(const std::vector<Mesh>& meshes) : impl_(new Impl) {
  // One thread builds: the tree, and with it every last bit, is the same each time.
  impl_->device = rtcNewDevice("threads=1,set_affinity=0");
  if (impl_->device == nullptr) {
    throw std::runtime_error("Embree does not start: error " +
                             std::to_string(rtcGetDeviceError(nullptr)));
  }
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);  // no leaks between triangles
  impl_->meshes = meshes;
  for (const Mesh& mesh : impl_->meshes) impl_->AddMesh(mesh);
  rtcCommitScene(impl_->scene);
  const RTCError error = rtcGetDeviceError(impl_->device);
  if (error != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree does not take the scene: error " + std::to_string(error));
  }
}

RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

Hit RayCaster::Cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  RTCRayHit query;
  query.ray = MakeRay(origin, direction, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
  Hit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.range = query.ray.tfar;
  hit.object = static_cast<int>(query.hit.geomID);
  hit.triangle = static_cast<int>(query.hit.primID);
  hit.normal = impl_->SmoothNormal(query.hit).normalized();
  if (hit.normal.dot(direction) > 0) hit.normal = -hit.normal;
  return hit;
}

void RayCaster::CastFan(const Eigen::Vector3d& origin, const Eigen::Vector3d* directions, int count,
                        Hit* hits) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (int first = 0; first < count; first += kPacket) {
    RTCRayHit8 query;
    alignas(32) int valid[kPacket];
    for (int i = 0; i < kPacket; ++i) {
      const int index = std::min(first + i, count - 1);
      valid[i] = first + i < count ? -1 : 0;
      query.ray.org_x[i] = static_cast<float>(origin.x());
      query.ray.org_y[i] = static_cast<float>(origin.y());
      query.ray.org_z[i] = static_cast<float>(origin.z());
      query.ray.dir_x[i] = static_cast<float>(directions[index].x());
      query.ray.dir_y[i] = static_cast<float>(directions[index].y());
      query.ray.dir_z[i] = static_cast<float>(directions[index].z());
      query.ray.tnear[i] = 0;
      query.ray.tfar[i] = std::numeric_limits<float>::infinity();
      query.ray.time[i] = 0;
      query.ray.mask[i] = 0xffffffffU;
      query.ray.id[i] = 0;
      query.ray.flags[i] = 0;
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, impl_->scene, &context, &query);
    for (int i = 0; i < kPacket && first + i < count; ++i) {
      Hit& hit = hits[first + i];
      hit = Hit();
      if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      hit.range = query.ray.tfar[i];
      hit.object = static_cast<int>(query.hit.geomID[i]);
      hit.triangle = static_cast<int>(query.hit.primID[i]);
    }
  }
}

bool RayCaster::Blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                        double range) const {
  RTCRay ray = MakeRay(origin, direction, range);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0;
}

}  // namespace rgbdt::simulate
