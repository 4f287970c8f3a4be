"""The force on a probe that presses into a gel, the decision whether a hard inclusion lies in it, and its playback.

Lengths are mm, moduli kPa, forces N; arrays of both forces are lateral first. What is refused raises Refused.
"""

from os import PathLike
from typing import Any, Callable, Iterator, Sequence, TypedDict, final, overload

from typing_extensions import NotRequired

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
build: dict[str, Any]

# A number in and a number out, or an array in and an array out.
_Floats = Any
_Path = str | PathLike[str]
_Progress = Callable[[int, int], object] | None

# The keys of answers, so that a type checker knows them; at run time these are plain dictionaries.
class _Parameters(TypedDict):
    position_mm: float
    depth_mm: float
    diameter_mm: float
    youngs_modulus_kpa: float

class _Axes(TypedDict):
    position_mm: list[float]
    depth_mm: list[float]
    diameter_mm: list[float]
    youngs_modulus_kpa: list[float]

class _Intervals(TypedDict):
    # No end where the likelihood still rises at the end of the bank.
    position_mm: list[float | None]
    depth_mm: list[float | None]
    diameter_mm: list[float | None]
    youngs_modulus_kpa: list[float | None]

# In SI, and only for parameters that the bank varies.
class _Place(TypedDict, total=False):
    position: dict[str, Any]
    inclusion_depth: dict[str, Any]
    diameter: dict[str, Any]
    youngs_modulus: dict[str, Any]

class _Located(_Place):
    inclusion: bool | None
    decision: str
    causes: list[str]
    reasons: list[str]
    decided_by: str
    theta_max: float
    theta_mixture: float
    eta: float
    gamma: float
    gamma_nominal: float
    amplitude: float
    amplitude_sd: float
    posterior_h1: float | None
    false_alarm_bound: float
    miss_bound: float
    hypotheses: int
    fits: bool
    noise_sd_lateral_n: float | None
    noise_sd_normal_n: float
    chi_square: float
    chi_square_limits: list[float] | None
    degrees: float
    whiteness: float | None
    theta_correlated: float | None
    level: float | None
    samples_in_air: list[list[int]]
    likeliest: _Parameters
    estimate: _Parameters
    mean: _Parameters
    interval_95: _Intervals
    places: NDArray[np.float64]
    probabilities: NDArray[np.float64]

class _Judged(_Place, total=False):
    inclusion: bool | None
    model: str
    decision: str
    causes: list[str]
    reasons: list[str]
    posterior_h1: float | None
    theta: float | None
    false_alarm: float | None
    miss: float | None
    class_without: dict[str, Any]
    class_with: dict[str, Any]
    remedy: str
    no_inclusion_down_to_m: float | None
    hypotheses: int
    several_inclusions: float
    level: float | list[float | None] | None
    noise_sd_lateral_n: float | list[float | None] | None
    noise_sd_normal_n: float | list[float | None] | None
    glitches: list[int]
    samples_in_air: list[list[int]]
    samples_left_out: int

class _LikeliestPlace(TypedDict):
    position_m: float
    depth_m: float
    diameter_m: float
    youngs_modulus_pa: float
    probability: float

class _Watched(TypedDict):
    samples: int
    missing: int
    outside: int
    posterior_h1: float
    theta: float
    decision: str | None
    decided_at_sample: int | None
    causes: list[str]
    reasons: list[str]
    likeliest: _LikeliestPlace | None
    places: int
    covered: int
    excluded: int
    open_positions_m: list[float]
    uncovered_positions_m: list[float]

class _Nuisances(TypedDict):
    t: float
    gamma: float
    gamma_nominal: float
    residual: float
    theta: float
    false_alarm: float
    miss: float
    rank: int
    degrees: float

class _BankPosterior(TypedDict):
    theta: list[float]
    posterior: list[float]
    theta_mixture: float
    theta_max: float
    hypothesis: int
    posterior_h1: float

class _Scan(TypedDict):
    theta: NDArray[np.float64]
    max_theta: Any
    gamma: Any
    refined_shift: Any
    shift: Any

class _Counts(TypedDict):
    pooled: list[int]
    rate: list[float]
    gamma: list[float]
    chi2: list[float]
    df: int

class _Imported(TypedDict):
    # Of depth and lateral position.
    largest_shift_mm: list[float]
    # Lateral, normal.
    residual_n: list[float | None]
    noise_sd_n: list[float | None] | None
    degrees_of_freedom: float | None

class _LargestDepth(TypedDict):
    diameter_mm: float
    youngs_modulus_kpa: float
    gamma: list[float]
    largest_depth_mm: float | None
    is_beyond_bank: bool
    # With classes=True.
    classes: NotRequired[dict[str, list[float]]]

class _SmallestDiameter(TypedDict):
    depth_mm: float
    youngs_modulus_kpa: float
    smallest_diameter_mm: float | None
    is_beyond_bank: bool

class _Reach(TypedDict):
    gamma_needed: float
    largest_depths: list[_LargestDepth]
    smallest_diameters: list[_SmallestDiameter]

# Calibration, in SI.
class _Force(TypedDict):
    force_n: float
    depth_m: float

class _Estimate(TypedDict):
    estimate: float
    interval: list[float]

class _Measured(_Estimate):
    unit: str

class _Modulus(_Measured):
    layer: str

class _EmpiricalLaw(TypedDict):
    k_n: _Estimate
    p: _Estimate
    q_per_mm: _Estimate

class _RelaxationTerm(TypedDict):
    tau_s: _Estimate
    # Of a Prony series, of a power law.
    weight: NotRequired[_Estimate]
    exponent: NotRequired[_Estimate]

class _Relaxation(TypedDict):
    form: str | dict[str, int]
    terms: list[_RelaxationTerm]

class _Held(TypedDict):
    seconds: float
    left: float

class _Calibrated(TypedDict):
    curve: str
    samples: int
    cause: str | None
    highest_force: _Force
    contact: _Measured | None
    offset: _Measured | None
    drift: _Measured | None
    noise_sd: _Measured | None
    phantom: Phantom | None
    # Where the curve cannot be judged.
    remedy: NotRequired[str]
    # Where it can: of a phantom, or without one.
    youngs_modulus: NotRequired[list[_Modulus]]
    empirical_law: NotRequired[_EmpiricalLaw]
    contact_law_correlation: NotRequired[float]
    relaxation: NotRequired[_Relaxation]
    held: NotRequired[list[_Held]]

# The analysis of answers.
class _Bounds(TypedDict):
    lower: float | None
    upper: float | None

class _Gamma(_Bounds):
    gamma: float | None

class _Rate(TypedDict):
    correct: int
    trials: int
    rate: float
    clopper_pearson: _Bounds
    wilson: _Bounds
    gamma: _Gamma

class _Clustered(TypedDict):
    standard_error: float
    bounds: _Bounds
    width_ratio: float
    gamma: _Gamma

class _Dispersion(TypedDict):
    chi_square: float
    degrees: int
    ratio: float
    p_value: float
    smallest_expected: float
    is_rough: bool

class _BetaBinomial(TypedDict):
    rate: float
    rate_bounds: _Bounds
    correlation: float
    correlation_bounds: _Bounds
    is_binomial: bool
    deviance_gain: float
    p_value: float

class _Inclusion(TypedDict):
    name: str
    depth_m: float
    pooled: _Rate
    clustered: _Clustered | None
    dispersion: _Dispersion | None
    beta_binomial: _BetaBinomial | None

class _Subject(TypedDict):
    name: str
    rates: list[_Rate]

class _Parameter(TypedDict):
    value: float
    bounds: _Bounds
    dispersed_bounds: _Bounds

class _Psychometric(TypedDict):
    midpoint_m: _Parameter
    spread_m: _Parameter
    lapse: _Parameter
    predicted: list[float]
    deviance: float
    degrees: int
    p_value: float | None
    p_value_dispersed: float | None

class _Condition(TypedDict):
    name: str
    inclusions: list[_Inclusion]
    subjects: list[_Subject]
    dispersion: float | None
    dispersion_degrees: int
    psychometric: _Psychometric | None

class _Difference(TypedDict):
    mean: float
    bounds: _Bounds | None
    p_value: float | None

class _InclusionDifference(_Difference):
    inclusion: str

class _Comparison(TypedDict):
    first: str
    second: str
    subjects: int
    overall: _Difference
    p_value_holm: float | None
    by_inclusion: list[_InclusionDifference]

class _NoiseLevel(TypedDict):
    name: str
    printed_n: float | None
    noise_n: float
    pooled_bounds_n: _Bounds | None
    clustered_bounds_n: _Bounds | None
    formula: str
    assumption: str

class _NoiseLevels(TypedDict):
    levels: list[_NoiseLevel]
    agreement: str

class _Analysis(TypedDict):
    confidence: float
    conditions: list[_Condition]
    comparisons: list[_Comparison]
    # Of the paper's table.
    noise_levels: NotRequired[_NoiseLevels]

class Refused(ValueError): ...

@final
class ProbeForce:
    def __new__(cls, lateral_n: float, normal_n: float) -> ProbeForce: ...
    def __iter__(self) -> Iterator[float]: ...
    @property
    def lateral_n(self) -> float: ...
    @property
    def normal_n(self) -> float: ...

@final
class Phantom:
    def __new__(cls, name: str, /, **edits: Any) -> Phantom: ...
    @staticmethod
    def from_toml(text_or_path: _Path) -> Phantom: ...
    @staticmethod
    def from_dict(tables: dict[str, Any]) -> Phantom: ...
    def edited(self, **edits: Any) -> Phantom: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def name(self) -> str: ...
    @property
    def height_mm(self) -> float: ...
    @property
    def inclusion_depth_mm(self) -> float | None: ...
    @overload
    def solve(  # type: ignore[overload-overlap]
        self, depth_mm: float, lateral_mm: float = 0.0, mesh_mm: float = 0.5, contact: str = "deformed-normal"
    ) -> ProbeForce: ...
    @overload
    def solve(
        self, depth_mm: ArrayLike, lateral_mm: ArrayLike = 0.0, mesh_mm: float = 0.5, contact: str = "deformed-normal"
    ) -> NDArray[np.float64]: ...
    def map(
        self,
        depths_mm: ArrayLike,
        laterals_mm: ArrayLike,
        mesh_mm: float = 0.5,
        contact: str = "deformed-normal",
        progress: _Progress = None,
        certify: bool = False,
    ) -> ForceMap: ...
    def write_vtu(
        self,
        path: _Path,
        depth_mm: float,
        lateral_mm: float = 0.0,
        mesh_mm: float = 0.5,
        contact: str = "deformed-normal",
    ) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class ForceMap:
    def __new__(
        cls,
        depths_mm: ArrayLike,
        laterals_mm: ArrayLike,
        lateral_n: ArrayLike | None,
        normal_n: ArrayLike,
        phantom: Phantom | None = None,
        note: str = "",
    ) -> ForceMap: ...
    @staticmethod
    def read(path: _Path) -> ForceMap: ...
    @staticmethod
    def from_json(text: str) -> ForceMap: ...
    def to_json(self) -> str: ...
    def write(self, path: _Path) -> None: ...
    @property
    def depths_mm(self) -> NDArray[np.float64]: ...
    @property
    def laterals_mm(self) -> NDArray[np.float64]: ...
    @property
    def lateral_n(self) -> NDArray[np.float64] | None: ...
    @property
    def normal_n(self) -> NDArray[np.float64]: ...
    @property
    def note(self) -> str: ...
    @property
    def phantom(self) -> Phantom | None: ...
    @property
    def certificate(self) -> dict[str, Any] | None: ...
    def row(self, depth_mm: float) -> NDArray[np.float64]: ...
    def sweep(self, depth_mm: float, laterals_mm: ArrayLike) -> NDArray[np.float64]: ...
    def force(self, depth_mm: ArrayLike, lateral_mm: ArrayLike) -> tuple[_Floats, _Floats]: ...
    # DataFrame, Dataset and Axes, where their packages are installed.
    def to_pandas(self) -> Any: ...
    def to_xarray(self) -> Any: ...
    def plot(self, ax: Any = None, of: ArrayLike | None = None) -> Any: ...
    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...

@final
class Statistic:
    def __new__(cls, theta: float, y_n: Sequence[float], gamma: float) -> Statistic: ...
    @property
    def theta(self) -> float: ...
    @property
    def y_n(self) -> list[float]: ...
    @property
    def gamma(self) -> float: ...

@final
class MatchedFilter:
    def __new__(cls, template: ArrayLike, noise_sd_n: ArrayLike) -> MatchedFilter: ...
    @property
    def gamma(self) -> float: ...
    @property
    def b_n(self) -> list[float]: ...
    @property
    def sigma_n(self) -> list[float]: ...
    def statistic(self, residual: ArrayLike) -> Statistic: ...
    def theta(self, residual: ArrayLike) -> _Floats: ...

def theta(observed: ArrayLike, f0: ArrayLike, f1: ArrayLike, noise_sd_n: ArrayLike) -> _Floats: ...
def statistic(observed: ArrayLike, f0: ArrayLike, f1: ArrayLike, noise_sd_n: ArrayLike) -> Statistic: ...
def theta_coloured(residual: ArrayLike, template: ArrayLike, covariance: ArrayLike) -> tuple[float, float]: ...
def theta_nuisances(
    residual: ArrayLike,
    template: ArrayLike,
    nuisances: ArrayLike,
    level: str = "known",
    bias: float = 0.0,
    eta: float = 0.0,
) -> _Nuisances: ...
def bank_posterior(
    residual: ArrayLike,
    templates: ArrayLike,
    nuisances: ArrayLike,
    prior: ArrayLike,
    level: str = "known",
    prior_h1: float = 0.5,
) -> _BankPosterior: ...
def scan(residual: ArrayLike, template: ArrayLike, noise_sd_n: ArrayLike) -> _Scan: ...
def simulate_theta(
    f0: ArrayLike, f1: ArrayLike, noise_sd_n: ArrayLike, inclusion: bool, trials: int, seed: int = 1999
) -> NDArray[np.float64]: ...
def decide(theta: ArrayLike, eta: ArrayLike) -> Any: ...
def posterior(theta: ArrayLike, prior_h1: ArrayLike) -> _Floats: ...
def map_threshold(prior_h1: ArrayLike) -> _Floats: ...
def bayes_threshold(
    prior_h1: ArrayLike, c00: ArrayLike, c01: ArrayLike, c10: ArrayLike, c11: ArrayLike
) -> _Floats: ...
def neyman_pearson_miss_threshold(gamma: ArrayLike, max_miss: ArrayLike) -> _Floats: ...
def neyman_pearson_false_alarm_threshold(gamma: ArrayLike, max_false_alarm: ArrayLike) -> _Floats: ...
def error_rates(gamma: ArrayLike, eta: ArrayLike) -> tuple[_Floats, _Floats]: ...
def roc_miss(gamma: ArrayLike, false_alarm: ArrayLike) -> _Floats: ...
def auc(gamma: ArrayLike) -> _Floats: ...
def two_afc(gamma: ArrayLike) -> _Floats: ...
def gamma_from_two_afc(p_correct: ArrayLike) -> _Floats: ...
def required_gamma(max_false_alarm: ArrayLike, max_miss: ArrayLike) -> _Floats: ...
def noise_budget(
    signal_n: float, max_false_alarm: float, max_miss: float, sources_n: ArrayLike
) -> tuple[float, float, float]: ...

@final
class Bank:
    def __new__(cls, reference: ForceMap, maps: Sequence[ForceMap]) -> Bank: ...
    @staticmethod
    def build(
        phantom: Phantom,
        probe_depth_mm: ArrayLike,
        laterals_mm: ArrayLike,
        offsets_mm: ArrayLike | None = None,
        depths_mm: ArrayLike | None = None,
        diameters_mm: ArrayLike | None = None,
        stiffnesses_kpa: ArrayLike | None = None,
        mesh_mm: float = 0.65,
        contact: str = "deformed-normal",
        progress: _Progress = None,
    ) -> Bank: ...
    @staticmethod
    def read(path: _Path) -> Bank: ...
    @staticmethod
    def from_json(text: str) -> Bank: ...
    def to_json(self) -> str: ...
    @staticmethod
    def plot(answer: _Located, parameter: str = "position_mm", ax: Any = None) -> Any: ...
    def write(self, path: _Path) -> None: ...
    @property
    def probe_depth_mm(self) -> float: ...
    @property
    def reference(self) -> ForceMap: ...
    @property
    def maps(self) -> list[ForceMap]: ...
    @property
    def axes(self) -> _Axes: ...
    def judge(
        self,
        positions_mm: ArrayLike,
        forces_n: ArrayLike,
        noise_sd_n: ArrayLike | None = None,
        known: str | Sequence[str] = (),
        zeroed: bool = False,
        sure: float = 0.95,
        prior: ArrayLike | None = None,
        prior_h1: float = 0.5,
        depths_mm: ArrayLike | None = None,
    ) -> _Judged: ...
    def locate(
        self,
        positions_mm: ArrayLike,
        forces_n: ArrayLike,
        noise_sd_n: ArrayLike | None = None,
        unknown: str | Sequence[str] = ("offset", "drift", "gain", "variance"),
        white: bool = False,
        depth_tolerance_mm: float = 0.3,
        max_miss: float | None = None,
        max_false_alarm: float | None = None,
        prior: ArrayLike | None = None,
        prior_h1: float = 0.5,
        zeroed: bool = False,
        depths_mm: ArrayLike | None = None,
    ) -> _Located: ...

@final
class Watcher:
    def __new__(
        cls,
        bank: Bank,
        noise_sd_n: ArrayLike,
        unknown: str | Sequence[str] = ("offset", "drift", "gain"),
        max_false_alarm: float = 0.01,
        max_miss: float = 0.05,
        prior: ArrayLike | None = None,
        prior_h1: float = 0.5,
        zeroed: bool = False,
    ) -> Watcher: ...
    def push(
        self,
        position_mm: float,
        normal_force_n: float,
        lateral_force_n: float | None = None,
        depth_mm: float | None = None,
    ) -> _Watched: ...

def calibrate(
    depths_mm: ArrayLike,
    forces_n: ArrayLike,
    times_s: ArrayLike | None = None,
    phantom: Phantom | None = None,
    layers: Sequence[int] = (),
    lateral_mm: float = 0.0,
    contact_mm: float | None = None,
    mesh_mm: float = 0.5,
) -> _Calibrated: ...
def import_map(
    depths_mm: ArrayLike,
    laterals_mm: ArrayLike,
    forces_n: ArrayLike,
    grid_mm: ArrayLike,
    smooth_mm: float | None = None,
    phantom: Phantom | None = None,
    note: str = "",
) -> tuple[ForceMap, _Imported]: ...
def reach(
    bank: Bank,
    noise_sd_n: ArrayLike,
    unknown: str | Sequence[str] = ("offset", "drift", "gain"),
    max_false_alarm: float = 0.01,
    max_miss: float = 0.05,
    positions_mm: ArrayLike | None = None,
    depths_mm: ArrayLike | None = None,
    classes: bool = False,
) -> _Reach: ...
def count_analysis(correct: ArrayLike, trials: int) -> _Counts: ...
def analyse_answers(table: Any = None) -> _Analysis: ...

@final
class ServoTable:
    def __new__(cls, map: ForceMap) -> ServoTable: ...
    def force(self, depth_mm: float, lateral_mm: float) -> tuple[float, float]: ...
    @property
    def stiffness_n_per_m(self) -> float: ...

@final
class Limits:
    def __new__(cls, force_n: float, slew_n: float, release_n: float, watchdog: int) -> Limits: ...

@final
class Sample:
    def __new__(
        cls, sequence: int, depth_mm: float, lateral_mm: float, deadman: bool, device_fault: bool = False
    ) -> Sample: ...

@final
class ServoState:
    def __new__(cls) -> ServoState: ...
    @property
    def mode(self) -> str: ...
    @property
    def fault(self) -> str | None: ...
    @property
    def force_n(self) -> list[float]: ...
    @property
    def missed(self) -> int: ...

def step(
    table: ServoTable, limits: Limits, state: ServoState, sample: Sample | None = None, request: str = "none"
) -> tuple[ServoState, list[float], bool]: ...
def ask(op: str, **arguments: Any) -> dict[str, Any]: ...
