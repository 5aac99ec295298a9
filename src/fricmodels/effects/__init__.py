"""The built-in effects, one a file, registered through the same hook as anybody's."""

from __future__ import annotations

from fricmodels.effects.asymmetry import Asymmetry
from fricmodels.effects.backlash import Backlash
from fricmodels.effects.chain_gravity import ChainGravity
from fricmodels.effects.cogging import Cogging
from fricmodels.effects.directional_efficiency import DirectionalEfficiency
from fricmodels.effects.drift import Drift
from fricmodels.effects.frictional_lag import FrictionalLag
from fricmodels.effects.gravity import Gravity
from fricmodels.effects.gravity_friction import GravityFriction
from fricmodels.effects.inertia_error import InertiaError
from fricmodels.effects.joint_compliance import JointCompliance
from fricmodels.effects.load_friction import LoadFriction
from fricmodels.effects.nonlinear_viscous import NonlinearViscous
from fricmodels.effects.other import Other
from fricmodels.effects.other_friction import OtherFriction
from fricmodels.effects.other_gravity import OtherGravity
from fricmodels.effects.other_inertia import OtherInertia
from fricmodels.effects.position_friction import PositionFriction
from fricmodels.effects.presliding import Presliding
from fricmodels.effects.proximal_coupling import ProximalCoupling
from fricmodels.effects.rising_stiction import RisingStiction
from fricmodels.effects.run_offset import RunOffset
from fricmodels.effects.sensor_delay import SensorDelay
from fricmodels.effects.step_change import StepChange
from fricmodels.effects.stiffness import Stiffness
from fricmodels.effects.stribeck import Stribeck
from fricmodels.effects.thermal import Thermal
from fricmodels.effects.torque_gain import TorqueGain
from fricmodels.effects.torque_offset import TorqueOffset
from fricmodels.effects.torque_ripple import TorqueRipple
from fricmodels.hookspecs import hookimpl
from fricmodels.term import Effect


@hookimpl
def fricmodels_effects() -> list[type[Effect]]:
    """Return the built-in effects."""
    return [
        Asymmetry,
        TorqueOffset,
        Stribeck,
        NonlinearViscous,
        LoadFriction,
        DirectionalEfficiency,
        TorqueGain,
        InertiaError,
        Gravity,
        GravityFriction,
        Stiffness,
        Cogging,
        PositionFriction,
        TorqueRipple,
        Presliding,
        FrictionalLag,
        RisingStiction,
        Backlash,
        SensorDelay,
        Thermal,
        Drift,
        StepChange,
        JointCompliance,
        Other,
        OtherFriction,
        OtherGravity,
        ChainGravity,
        OtherInertia,
        ProximalCoupling,
        RunOffset,
    ]
