"""A three-piece truck in Exudyn, packaged by pythonfmu: a truck from another house.

Five rigid bodies with all six degrees of freedom, joined by Exudyn's connectors: spring, limit stop
and bristle friction along an axis. X points forward, Y left, Z up. The carbody is one more body, so
heavy that it moves as it is told.
"""

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    CoordinateSpringDamper,
    CoordinateSpringDamperExt,
    LoadCoordinate,
    MarkerBodiesRelativeRotationCoordinate,
    MarkerBodiesRelativeTranslationCoordinate,
    MarkerNodeCoordinate,
    NodeGenericData,
    NodePointGround,
)
from exudyn.utilities import RigidBodyInertia
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {  # SI, the loaded car's
    "half_wheelbase": (0.8636, "m"),
    "half_gauge": (0.75565, "m"),
    "half_frame_distance": (0.9906, "m"),
    "plate_height": (0.65405, "m"),
    "axle_load": (244652.2, "N"),
    "wheelset_mass": (1202.02, "kg"),
    "wheelset_inertia": (762.648, "kg.m2"),
    "frame_mass": (430.913, "kg"),
    "frame_inertia": (135.582, "kg.m2"),
    "bolster_mass": (566.99, "kg"),
    "bolster_inertia": (210.717, "kg.m2"),
    "plate_stiffness": (8.756341e8, "N/m"),
    "plate_roll_stiffness": (5.649241e7, "N.m/rad"),
}
CAR = ("y", "z", "roll", "yaw")
UNITS = {"y": "m", "z": "m", "roll": "rad", "yaw": "rad"}
AXIS = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}
TURN = {"roll": [1, 0, 0], "pitch": [0, 1, 0], "yaw": [0, 0, 1]}
COORDINATE = {"x": 0, "y": 1, "z": 2, "roll": 3, "pitch": 4, "yaw": 5}
WHEELS = [f"{axle}_{side}" for axle in ("lead", "trail") for side in ("left", "right")]

RADIUS = 0.4191  # of the wheels [m]: axles, side frames and springs are that high above the rails
HEAVY = 1e13  # kg, of the body that stands for the car: nothing pushes it
STEP = 1e-4  # largest step of Exudyn's integrator [s]: in longer ones its stuck friction creeps


class ExudynTruck(Fmi2Slave):
    author = "an example of tracktrain"
    description = "Three-piece truck of rigid bodies, assembled in Exudyn"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name, (value, unit) in PARAMETERS.items():
            self.port(name, value, unit, Fmi2Causality.parameter, Fmi2Variability.fixed)
        for name in CAR:
            self.port(f"body_{name}", 0.0, UNITS[name], Fmi2Causality.input)
            self.port(f"body_{name}_rate", 0.0, f"{UNITS[name]}/s", Fmi2Causality.input)
        for k in (1, 2):
            self.port(f"rail_Fy_{k}", 0.0, "N", Fmi2Causality.input)
            self.port(f"rail_Mz_{k}", 0.0, "N.m", Fmi2Causality.input)
        for wheel in WHEELS:
            self.port(f"rail_{wheel}", 0.0, "m", Fmi2Causality.input)
        for k in (1, 2):
            for name, unit in (
                ("y", "m"),
                ("psi", "rad"),
                ("y_rate", "m/s"),
                ("psi_rate", "rad/s"),
            ):
                self.port(f"wheelset_{name}_{k}", 0.0, unit, Fmi2Causality.output)
        for wheel in WHEELS:
            self.port(f"Q_{wheel}", 0.0, "N", Fmi2Causality.output)
        for name, unit in (("Fy", "N"), ("Fz", "N"), ("Mx", "N.m"), ("Mz", "N.m")):
            self.port(f"bolster_{name}", 0.0, unit, Fmi2Causality.output)

    def port(self, name, value, unit, causality, variability=None):
        setattr(self, name, value)
        variability = variability or Fmi2Variability.continuous
        description = f"[{unit}]"  # pythonfmu has no units
        self.register_variable(
            Real(name, causality=causality, variability=variability, description=description)
        )

    def exit_initialization_mode(self):
        self.system = exu.SystemContainer()
        self.mbs = self.system.AddSystem()
        self.ground = self.mbs.AddNode(NodePointGround())
        self.zero = self.mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=self.ground, coordinate=0))
        x, y = self.half_wheelbase, self.half_frame_distance
        wheelset = [self.wheelset_inertia, 0.12 * self.wheelset_inertia, self.wheelset_inertia]
        frame = [0.1 * self.frame_inertia, self.frame_inertia, self.frame_inertia]
        bolster = [self.bolster_inertia, 0.1 * self.bolster_inertia, self.bolster_inertia]
        self.lead = self.body(self.wheelset_mass, wheelset, [x, 0, RADIUS])
        self.trail = self.body(self.wheelset_mass, wheelset, [-x, 0, RADIUS])
        self.left = self.body(self.frame_mass, frame, [0, y, RADIUS])
        self.right = self.body(self.frame_mass, frame, [0, -y, RADIUS])
        self.bolster = self.body(self.bolster_mass, bolster, [0, 0, self.plate_height])
        self.car = self.body(HEAVY, [HEAVY] * 3, [0, 0, self.plate_height])
        self.adapters()
        self.springs()
        self.plate = self.centre_plate()
        self.rails, self.loads = self.wheels()
        self.mbs.Assemble()
        self.settings = self.integration()
        self.move_car()
        self.read()

    def body(self, mass, inertia, place):
        made = self.mbs.CreateRigidBody(
            inertia=RigidBodyInertia(mass, np.diag(inertia)),
            nodeType=exu.NodeType.RotationRxyz,
            referencePosition=place,
            returnDict=True,
        )
        return made["bodyNumber"], made["nodeNumber"], place

    def joint(self, first, second, place, way, stiffness, damping=0.0, **more):
        """A connector between two bodies at a place of the truck, along or about an axis.

        more: friction (force, stiffness) and stop (free play, stiffness), each if there is one.
        """
        at = [np.subtract(place, body[2]) for body in (first, second)]
        bodies = {"bodyNumbers": [second[0], first[0]], "localPosition0": at[1],
                  "localPosition1": at[0]}  # fmt: skip
        kind, axes = MarkerBodiesRelativeTranslationCoordinate, AXIS
        if way in TURN:
            kind, axes = MarkerBodiesRelativeRotationCoordinate, TURN
        marker = self.mbs.AddMarker(kind(axis0=axes[way], **bodies))
        pair = [self.zero, marker]
        if not more:
            return self.mbs.AddObject(
                CoordinateSpringDamper(markerNumbers=pair, stiffness=stiffness, damping=damping)
            )
        force, stuck = more.get("friction", (0.0, 0.0))
        play, stop = more.get("stop", (1e3, 0.0))
        memory = self.mbs.AddNode(
            NodeGenericData(numberOfDataCoordinates=3, initialCoordinates=[0, 0, 0])
        )
        return self.mbs.AddObject(
            CoordinateSpringDamperExt(
                markerNumbers=pair,
                nodeNumber=memory,
                stiffness=stiffness,
                damping=damping,
                dynamicFrictionForce=force,
                stickingStiffness=stuck,
                stickingDamping=2e-4 * stuck,
                limitStopsUpper=play,
                limitStopsLower=-play,
                limitStopsStiffness=stop,
                limitStopsDamping=2e-4 * stop,
                useLimitStops=True,
            )
        )

    def adapters(self):
        """A side frame rests on each axle: stiff upwards, held by dry friction along and across."""
        for axle in (self.lead, self.trail):
            for frame in (self.left, self.right):
                place = [axle[2][0], frame[2][1], RADIUS]
                self.joint(frame, axle, place, "z", 4e8, 2e4)
                self.joint(frame, axle, place, "roll", 2e7, 2e3)
                for way, play in (("x", 1.6e-3), ("y", 6.4e-3)):
                    hold = {"friction": (66723.3, 1.75e8), "stop": (play, 1.75e8)}
                    self.joint(frame, axle, place, way, 0.0, 0.0, **hold)
                self.warp(frame, axle, place)

    def springs(self):
        """A bolster end on its coil group, between two wedges."""
        for frame in (self.left, self.right):
            place = [0, frame[2][1], RADIUS]
            wedge = {"friction": (15568.8, 3.5e8)}
            across = {"friction": (13344.7, 3.68e7), "stop": (0.0127, 8.76e7)}
            self.joint(self.bolster, frame, place, "z", 3.94e6, 0.0, **wedge)
            self.joint(self.bolster, frame, place, "y", 2.43e6, 0.0, **across)
            self.joint(self.bolster, frame, place, "x", 1.75e8, 4e4)
            self.joint(self.bolster, frame, place, "pitch", 1e6, 1e3)
            self.warp(self.bolster, frame, place)

    def warp(self, first, second, place):
        """One of the six joints that resist lozenging."""
        hold = {"friction": (2636.0, 4.847e6), "stop": (0.00218, 1.318e6)}
        self.joint(first, second, place, "yaw", 6.459e5, 0.0, **hold)

    def centre_plate(self):
        """The connectors under the car, by what they do to it."""
        ratio = 0.2 * np.sqrt(self.plate_stiffness * self.bolster_mass)
        turning = 0.2 * np.sqrt(self.plate_roll_stiffness * self.bolster_inertia)
        rub = {"friction": (111205.5, 7.005e7), "stop": (3.175e-3, 1.751e8)}
        ends = (self.bolster, self.car, [0, 0, self.plate_height])
        return {
            "Fy": self.joint(*ends, "y", 0.0, 0.0, **rub),
            "Fz": self.joint(*ends, "z", self.plate_stiffness, ratio),
            "Mx": self.joint(*ends, "roll", self.plate_roll_stiffness, turning),
            "Mz": self.joint(*ends, "yaw", 0.0, 0.0, friction=(5649.2, 4.519e5)),
        }

    def wheels(self):
        """Springs for the rails under the wheels, loads in the plane, and what tows the truck."""
        rails, loads = {}, []
        for k, (name, axle) in enumerate((("lead", self.lead), ("trail", self.trail)), start=1):
            for side, sign in (("left", 1), ("right", -1)):
                at = [axle[2][0], sign * self.half_gauge, RADIUS]
                rails[f"{name}_{side}"] = self.rail(axle, at)
            for way, stiffness in (("x", 2e7), ("pitch", 1e5)):
                marker = self.coordinate(axle, way)
                pair = [self.zero, marker]
                self.mbs.AddObject(
                    CoordinateSpringDamper(
                        markerNumbers=pair, stiffness=stiffness, damping=1e-3 * stiffness
                    )
                )
            for force, way, arm in (
                (f"rail_Fy_{k}", "y", 1.0),
                (f"rail_Fy_{k}", "roll", RADIUS),
                (f"rail_Mz_{k}", "yaw", 1.0),
            ):
                marker = self.coordinate(axle, way)
                load = self.mbs.AddLoad(LoadCoordinate(markerNumber=marker, load=0.0))
                loads.append((load, force, arm))
        return rails, loads

    def rail(self, axle, at):
        if not hasattr(self, "earth"):
            self.earth = self.mbs.CreateGround(), None, [0, 0, 0]
        return self.joint(axle, self.earth, at, "z", 4e8, 4e4)

    def coordinate(self, body, way):
        return self.mbs.AddMarker(
            MarkerNodeCoordinate(nodeNumber=body[1], coordinate=COORDINATE[way])
        )

    def integration(self):
        settings = exu.SimulationSettings()
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.8
        settings.timeIntegration.newton.useModifiedNewton = True
        settings.timeIntegration.newton.numericalDifferentiation.forODE2 = False
        settings.timeIntegration.verboseMode = 0
        settings.solutionSettings.writeSolutionToFile = False
        settings.solutionSettings.sensorsWritePeriod = 1e9
        settings.displayStatistics = False
        settings.displayComputationTime = False
        return settings

    def do_step(self, current_time, step_size):
        for load, force, arm in self.loads:
            self.mbs.SetLoadParameter(load, "load", arm * getattr(self, force))
        for wheel, rail in self.rails.items():
            self.mbs.SetObjectParameter(rail, "offset", getattr(self, f"rail_{wheel}"))
        self.move_car()
        integration = self.settings.timeIntegration
        integration.startTime = current_time
        integration.endTime = current_time + step_size
        integration.numberOfSteps = max(1, int(np.ceil(step_size / STEP - 1e-9)))
        try:
            self.mbs.SolveDynamic(self.settings, updateInitialValues=True)
        except ValueError:  # it has said why; an exception here would end the program
            return False
        self.read()
        return True

    def move_car(self):
        """Put the car where the inputs have it, with its velocity."""
        initial = exu.ConfigurationType.Initial
        first = 6 * 5
        q = self.mbs.systemData.GetODE2Coordinates(initial)
        v = self.mbs.systemData.GetODE2Coordinates_t(initial)
        for name in CAR:
            q[first + COORDINATE[name]] = getattr(self, f"body_{name}")
            v[first + COORDINATE[name]] = getattr(self, f"body_{name}_rate")
        self.mbs.systemData.SetODE2Coordinates(q, initial)
        self.mbs.systemData.SetODE2Coordinates_t(v, initial)

    def read(self):
        """Outputs from the present state."""
        q = self.mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Initial)
        v = self.mbs.systemData.GetODE2Coordinates_t(exu.ConfigurationType.Initial)
        for k in (1, 2):
            first = 6 * (k - 1)
            self.__dict__[f"wheelset_y_{k}"] = float(q[first + 1])
            self.__dict__[f"wheelset_psi_{k}"] = float(q[first + 5])
            self.__dict__[f"wheelset_y_rate_{k}"] = float(v[first + 1])
            self.__dict__[f"wheelset_psi_rate_{k}"] = float(v[first + 5])
        force = exu.OutputVariableType.Force
        for wheel, rail in self.rails.items():
            pressed = self.mbs.GetObjectOutput(rail, force)
            setattr(self, f"Q_{wheel}", max(0.5 * self.axle_load - float(pressed), 0.0))
        for name, connector in self.plate.items():
            setattr(self, f"bolster_{name}", -float(self.mbs.GetObjectOutput(connector, force)))
