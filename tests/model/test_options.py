"""The options of a world: those of a single model, those that all models share, and a warning about conflicts."""

import mujoco
import pytest

from tutorial.errors import TutorialError
from tutorial.model.options import OPTIONS
from tutorial.world import Placement, compose

BODY = '<worldbody><body><joint name="J"/><geom size="0.1"/></body></worldbody><actuator><motor joint="J"/></actuator>'
JELLY = (
    '<worldbody><flexcomp name="f" type="grid" dim="3" count="3 3 3" mass="1"><elasticity young="1e4"/></flexcomp>'
    "</worldbody>"
)
SAID = "The models set different values for options that apply to the whole world: "

VALUES = {
    **dict.fromkeys(OPTIONS, "3"),
    "timestep": "0.003",
    "integrator": "RK4",
    "cone": "elliptic",
    "jacobian": "sparse",
    "solver": "CG",
    **dict.fromkeys(("gravity", "wind", "magnetic"), "1 2 3"),
    **{"o_solref": "0.1 1", "o_solimp": "0.1 0.2 0.3 0.4 2", "o_friction": "1 2 3 4 5"},
}


@pytest.fixture
def world(tmp_path):
    """Compose models, each with a body and the given content."""

    def world(*contents, body=BODY, time_step=None):
        paths = [tmp_path / f"{'abc'[i]}.xml" for i in range(len(contents))]
        for path, content in zip(paths, contents):
            path.write_text(f"<mujoco>{content}{body}</mujoco>")
        return compose([Placement(path.stem.upper(), path) for path in paths], time_step)

    return world


def option(**values):
    return f"<option {' '.join(f'{name}={value!r}' for name, value in values.items())}/>"


@pytest.mark.parametrize("name", [each for each in OPTIONS if not each.startswith(("disable", "enable"))])
def test_single_model(world, name, caplog):
    text = option(**{name: VALUES[name]})
    own = mujoco.MjSpec.from_string(f"<mujoco>{text}</mujoco>").compile().opt
    default = world("").opt
    found = world(text, "").opt
    for each in OPTIONS:
        expected = getattr(own if each == name else default, each)
        assert getattr(found, each) == pytest.approx(expected), each
    assert caplog.records == []


def test_flags_and_groups(world):
    model = world('<option actuatorgroupdisable="1 3"><flag contact="disable" energy="enable"/></option>')
    opt = model.opt
    assert opt.disableflags == mujoco.mjtDisableBit.mjDSBL_CONTACT
    assert opt.enableflags == mujoco.mjtEnableBit.mjENBL_ENERGY
    assert opt.disableactuator == 0b1010


def test_defaults(world):
    opt = world("", "").opt
    assert (opt.timestep, opt.gravity.tolist()) == (0.001, [0, 0, -9.80665])
    assert opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert world(option(timestep="0.004"), time_step=0.002).opt.timestep == 0.002


def test_explicit_default(world):
    assert world(option(integrator="Euler")).opt.integrator == mujoco.mjtIntegrator.mjINT_EULER


def test_agreeing_models(world, caplog):
    same = option(cone="elliptic", gravity="0 0 -1.62")
    opt = world(same, same, "").opt
    assert (opt.cone, opt.gravity[2]) == (mujoco.mjtCone.mjCONE_ELLIPTIC, -1.62)
    assert caplog.records == []


@pytest.mark.parametrize(
    ("contents", "said"),
    [
        (
            [option(integrator="RK4"), "", option(integrator="Euler")],
            "integrator is implicitfast (RK4 in a.xml, Euler in c.xml)",
        ),
        (
            [option(gravity="0 0 0", impratio="10"), option(gravity="0 0 -9.81", impratio="2")],
            "impratio is 1 (10 in a.xml, 2 in b.xml); gravity is 0 0 -9.80665 (0 0 0 in a.xml, 0 0 -9.81 in b.xml)",
        ),
        (
            ['<option><flag contact="disable" energy="enable"/></option>', ""],
            "flag contact is enable (disable in a.xml); flag energy is disable (enable in a.xml)",
        ),
        (
            ["", '<option actuatorgroupdisable="2"/>'],
            "actuatorgroupdisable is empty (2 in b.xml)",
        ),
    ],
)
def test_disagreeing_models(world, caplog, contents, said):
    opt, own = world(*contents).opt, world("").opt
    assert [getattr(opt, name) == pytest.approx(getattr(own, name)) for name in OPTIONS] == [True] * len(OPTIONS)
    assert caplog.messages == [f"{SAID}{said}. Set each one to the same value in all models, or omit it everywhere."]


@pytest.mark.parametrize("content", ["", option(integrator="discrete"), option(integrator="Euler")])
def test_soft_body(world, content):
    assert world(content, body=JELLY).nflex == 1


def test_compile_error(world):
    said = r"does not compile[^$]*\n.*cone is pyramidal \(elliptic in a.xml, pyramidal in b.xml\)"
    with pytest.raises(TutorialError, match=said):
        world(option(cone="elliptic"), option(cone="pyramidal"), body="<worldbody><body><joint/></body></worldbody>")


def test_sizes_are_the_largest(world, caplog, recwarn):
    model = world('<size memory="10M" nuser_jnt="2" nkey="1"/>', '<size memory="20M" nuserdata="3"/>')
    assert (model.nuserdata, model.nuser_jnt, model.narena) == (3, 2, 20 * 2**20)
    assert (caplog.messages, list(recwarn)) == ([], [])


def test_attached_file(world, tmp_path, caplog, recwarn, monkeypatch):
    monkeypatch.setattr("tutorial.world.mujoco_warns._due", 0.0)
    monkeypatch.setattr("tutorial.world.mujoco_warns._unsaid", 0)
    (tmp_path / "arm.xml").write_text(f'<mujoco model="arm">{option(cone="elliptic")}{BODY}</mujoco>')
    attach = '<asset><model name="arm" file="arm.xml"/></asset><worldbody><attach model="arm" prefix="P_"/></worldbody>'
    world('<option cone="pyramidal"/>' + attach)
    assert caplog.messages == [
        "a model file attaches another file whose options differ. The attached file's options are not used."
    ]
    assert list(recwarn) == []
