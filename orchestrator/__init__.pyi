from .errors import (
    ArchiveError,
    CouplingError,
    DamageError,
    DimensionError,
    FmuError,
    OrchestratorError,
    ProfileError,
    ResultsError,
    UnitError,
    UnwrittenError,
    choices,
    listed,
    plain,
)
from .files import content_of, whole_file
from .fmu.archive import Archive, open_archive
from .fmu.arrays import shaped, taken_apart
from .fmu.description import Description, Limit, Tangent, Variable
from .fmu.given import in_unit
from .fmu.port_map import Port, PortMap
from .fmu.read import Contents, describe, open_fmu, survey
from .fmu.units import Quantity, conversion, scale_of
from .masters.base import Master, all_masters, master_named, options_of_masters
from .masters.coupling import Way, couple, interpolated
from .masters.gauss_seidel import GaussSeidel
from .masters.iterated import Iterated
from .masters.jacobi import Jacobi
from .masters.one_pass import OnePass
from .naming import is_pattern, picked
from .notes import Advice, Detail
from .plan.plan import Plan, component_description, make_plan
from .plan.ports import Problem, fit
from .results.callback import Callback
from .results.csv_table import CsvTable
from .results.energy import BondResidual
from .results.folder import owned
from .results.metrics import dominant_frequency, peak, rms, vertex
from .results.netcdf import RESULTS_NAME, ResultsFile
from .results.provenance import Provenance
from .results.reading import open_results
from .results.run import Run
from .results.signals import Response, Responses, Signal, Signals, open_signals
from .results.sink import Header, Sink
from .results.stationary import (
    Estimate,
    Settling,
    State,
    frequency_of,
    from_time,
    peak_of,
    percentile_of,
    rms_of,
    settling,
)
from .run.checkpoint import read_checkpoint
from .run.execution import Execution
from .run.log import Log
from .run.outcome import Kind, Outcome
from .run.request import Request, read_request
from .run.settings import Settings
from .run.simulate import resume, simulate
from .slaves.departure import ends_when_asked
from .slaves.inline import InlineModel
from .slaves.session import Session
from .ssp.port_map import read_port_map
from .ssp.reader import read_ssp
from .ssp.writer import write_ssp
from .system.diagram import diagram
from .system.profile import Profile, read_profile
from .system.system import Component, Connection, Experiment, PowerBond, System, Value
from .system.transformation import Linear, Table
from .trust.findings import Level, Verdict
from .trust.self_test import CHECKS
from .trust.tested import self_tests
from .whole.coupled import CoupledCode, coupled_code
from .whole.linearise import LinearModel, linearise, linearised
from .whole.monolith import monolith
from .whole.verify import verify

__all__ = [
    "CHECKS",
    "RESULTS_NAME",
    "Advice",
    "Archive",
    "ArchiveError",
    "BondResidual",
    "Callback",
    "Component",
    "Connection",
    "Contents",
    "CoupledCode",
    "CouplingError",
    "CsvTable",
    "DamageError",
    "Description",
    "Detail",
    "DimensionError",
    "Estimate",
    "Execution",
    "Experiment",
    "FmuError",
    "GaussSeidel",
    "Header",
    "InlineModel",
    "Iterated",
    "Jacobi",
    "Kind",
    "Level",
    "Limit",
    "Linear",
    "LinearModel",
    "Log",
    "Master",
    "OnePass",
    "OrchestratorError",
    "Outcome",
    "Plan",
    "Port",
    "PortMap",
    "PowerBond",
    "Problem",
    "Profile",
    "ProfileError",
    "Provenance",
    "Quantity",
    "Request",
    "Response",
    "Responses",
    "ResultsError",
    "ResultsFile",
    "Run",
    "Session",
    "Settings",
    "Settling",
    "Signal",
    "Signals",
    "Sink",
    "State",
    "System",
    "Table",
    "Tangent",
    "UnitError",
    "UnwrittenError",
    "Value",
    "Variable",
    "Verdict",
    "Way",
    "all_masters",
    "choices",
    "component_description",
    "content_of",
    "conversion",
    "couple",
    "coupled_code",
    "describe",
    "diagram",
    "dominant_frequency",
    "ends_when_asked",
    "fit",
    "frequency_of",
    "from_time",
    "in_unit",
    "interpolated",
    "is_pattern",
    "linearise",
    "linearised",
    "listed",
    "make_plan",
    "master_named",
    "monolith",
    "open_archive",
    "open_fmu",
    "open_results",
    "open_signals",
    "options_of_masters",
    "owned",
    "peak",
    "peak_of",
    "percentile_of",
    "picked",
    "plain",
    "read_checkpoint",
    "read_port_map",
    "read_profile",
    "read_request",
    "read_ssp",
    "resume",
    "rms",
    "rms_of",
    "scale_of",
    "self_tests",
    "settling",
    "shaped",
    "simulate",
    "survey",
    "taken_apart",
    "verify",
    "vertex",
    "whole_file",
    "write_ssp",
]
