from os import PathLike
from typing import Any, Callable, Iterable, Iterator, Optional, Union

import numpy as np
from numpy.typing import NDArray

Path = Union[str, PathLike[str]]
__version__: str

class InputError(ValueError):
    """Bad input: what is wrong, where, and what to do."""

class Cloud:
    """A LIDAR's sweep as the sensor saw it, LIDAR frame: point i lies in line i // beams, beam
    i % beams. N points; what a sensor does not tell is None."""
    @property
    def sweep_utime(self) -> int: """Start of the sweep [us]."""
    @property
    def first_line(self) -> int: ...
    @property
    def lines(self) -> int: ...
    @property
    def beams(self) -> int: """Per line; a cloud without order is one line."""
    @property
    def organised(self) -> bool: ...
    @property
    def points(self) -> NDArray[np.float32]: """N x 3 [m]; NaN where the beam returned nothing."""
    @property
    def directions(self) -> Optional[NDArray[np.float32]]: """N x 3, unit vectors, of misses."""
    @property
    def origins(self) -> Optional[NDArray[np.float32]]: """lines x 3 [m]: where beams start."""
    @property
    def intensity(self) -> Optional[NDArray[np.float32]]: """N, 0 to 1."""
    @property
    def utime(self) -> Optional[NDArray[np.int64]]: """N [us]."""
    @property
    def ring(self) -> Optional[NDArray[np.uint16]]: """N: laser, or beam of a turned scanner."""
    def __len__(self) -> int: ...

class Image:
    """One frame of one camera."""
    @property
    def camera(self) -> str: """Its name in the rig."""
    @property
    def utime(self) -> int: """Middle of the exposure [us]."""
    @property
    def exposure_s(self) -> float: """0: unknown."""
    @property
    def format(self) -> str: """MONO8, MONO16, BAYER_RG8, BAYER_GR8, BAYER_GB8, BAYER_BG8 or BGR8."""
    @property
    def pixels(self) -> NDArray[Any]:
        """height x width, uint8 or (MONO16) uint16; of BGR8 height x width x 3: blue, green, red."""

class FusedCloud:
    """The points of a sweep that returned, coloured; LIDAR frame. N points."""
    @property
    def sweep_utime(self) -> int: ...
    @property
    def cameras(self) -> list[str]: """Bit i of `valid` stands for cameras[i]."""
    @property
    def calibration_utime(self) -> list[int]: """Of each camera's calibration; 0: none."""
    @property
    def map_from_lidar(self) -> Optional[NDArray[np.float64]]: """4 x 4; None: no pose is known."""
    @property
    def points(self) -> NDArray[np.float32]: """N x 3 [m]."""
    @property
    def rgb(self) -> NDArray[np.uint8]: """N x 3: red, green, blue, 1 to 255; 0 0 0: not seen."""
    @property
    def intensity(self) -> NDArray[np.float32]: """N, 0 to 1; NaN: unknown."""
    @property
    def utime(self) -> NDArray[np.int64]: """N [us]."""
    @property
    def temperature_k(self) -> NDArray[np.float32]: """N [K]; NaN: no thermal camera saw it."""
    @property
    def temperature_sigma_k(self) -> NDArray[np.float32]: """N [K], 1 sigma; NaN: unknown."""
    @property
    def thermal_counts(self) -> NDArray[np.float32]: """N; NaN: no thermal camera saw it."""
    @property
    def valid(self) -> NDArray[np.uint32]: """N: which cameras saw it."""
    def to_numpy(self) -> NDArray[np.void]:
        """A structured array of its own, with the columns of fused.ply."""
    def write_ply(self, path: Path) -> None: ...
    def write_pcd(self, path: Path) -> None: ...
    def __len__(self) -> int: ...

class Lens:
    """A lens; OpenCV's order and meaning, pixel centres at integers."""
    @property
    def model(self) -> str: """pinhole or fisheye."""
    @property
    def camera_matrix(self) -> NDArray[np.float64]: """3 x 3 [px]."""
    @property
    def distortion(self) -> NDArray[np.float64]:
        """pinhole: k1 k2 p1 p2 k3 k4 k5 k6; fisheye: k1 k2 k3 k4."""

class CameraCalibration:
    """Where a camera sits: point_in_camera = camera_from_lidar @ point_in_lidar."""
    @property
    def camera(self) -> str: ...
    @property
    def camera_from_lidar(self) -> NDArray[np.float64]: """4 x 4, translation in metres."""
    @property
    def quaternion_wxyz(self) -> list[float]: """Of camera_from_lidar."""
    @property
    def translation_m(self) -> list[float]: """Of camera_from_lidar."""
    @property
    def covariance(self) -> Optional[NDArray[np.float64]]:
        """6 x 6 of (rx ry rz [rad], tx ty tz [m]), camera axes: truth = Exp(delta) @ estimate.
        None: not estimated."""
    @property
    def status(self) -> str: """CONVERGED, NOT_CONVERGED, DEGENERATE, CONTRADICTED, ..."""
    @property
    def detail(self) -> str: """In words: why, and what to do."""
    @property
    def converged(self) -> bool: """Whether the pose is one to use."""
    @property
    def lens(self) -> Optional[Lens]: """That belongs to the pose; None: the rig file's."""

class Calibration:
    """By camera, like a dict: calibration["rgb"]."""
    @property
    def method(self) -> str: ...
    @property
    def rig_hash(self) -> str: ...
    @property
    def utime(self) -> int: """Of the newest image used [us]."""
    @property
    def cameras(self) -> list[str]: ...
    def __getitem__(self, camera: str) -> CameraCalibration: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[str]: ...
    def __contains__(self, camera: str) -> bool: ...
    def keys(self) -> list[str]: ...
    def items(self) -> list[tuple[str, CameraCalibration]]: ...
    def write(self, path: Path) -> None: """A calibration.textproto, atomically."""

class View:
    @property
    def name(self) -> str: ...
    @property
    def heldout(self) -> bool: ...
    @property
    def cloud(self) -> Cloud: ...
    @property
    def images(self) -> list[Image]: ...

class Session:
    """A session directory."""
    @property
    def root(self) -> Any: """A pathlib.Path."""
    @property
    def views(self) -> list[str]: ...
    @property
    def cameras(self) -> list[str]: ...
    @property
    def rig_text(self) -> str: """rig.textproto."""
    @property
    def rig_hash(self) -> str: ...
    def view(self, name: str) -> View: """Reads its cloud and images. KeyError: no such view."""

class Calibrated:
    calibration: Calibration
    report: dict[str, Any]
    unreadable: list[str]
    def write(self, directory: Path) -> None: ...

class LogEvent:
    number: int
    channel: str
    receive_utime: int
    data: bytes
    @property
    def type(self) -> Optional[type]: ...
    @property
    def message(self) -> Any: ...
    @property
    def utime(self) -> Optional[int]: ...
    def arrays(self) -> Union[Image, Cloud, FusedCloud, None]: ...

class Log(Iterator[LogEvent]):
    @property
    def unreadable_bytes(self) -> int: ...

def open_session(dir: Path) -> Session: ...
def read_calibration(path: Path) -> Calibration: ...
def read_report(path: Path) -> dict[str, Any]: ...
def read_cloud(path: Path) -> Cloud: """A PCD file."""
def read_fused(path: Path) -> FusedCloud: """A fused cloud, PLY or PCD."""
def read_log(path: Path) -> Log: ...
def calibrate(dir: Path, method: str = "auto", without: Iterable[str] = (),
              progress: Optional[Callable[[str], Any]] = None) -> Calibrated: ...
def fuse(view: View, calibration: Calibration, anyway: bool = False) -> FusedCloud: ...
def __getattr__(name: str) -> Any: """The LCM types: cloud_t, image_t, ..."""
