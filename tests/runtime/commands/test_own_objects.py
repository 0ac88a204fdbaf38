"""A person's own LIBERO objects on the command line, and what a task that LIBERO cannot build is told to lack."""

import json
import sys

import pytest

from onto_compiler.command import FINDINGS, MISUSE
from onto_compiler.problems import OntoError
from runtime.cli import main
from runtime.worlds.libero.simulator.assets import find_task

pytestmark = pytest.mark.sim
MODULE = """
import os
import {helper}
from libero.libero.envs.base_object import register_object
from robosuite.models.objects import MujocoXMLObject


@register_object
class {name}(MujocoXMLObject):
    def __init__(self, name="cup", obj_name="cup"):
        path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cup.xml")
        joints = [dict(type="free", damping="0.0005")]
        super().__init__(path, name=name, joints=joints, obj_type="all", duplicate_collision_geoms=False)
        self.category_name = "cup"
        self.rotation, self.rotation_axis = (0.0, 0.0), "z"
        self.object_properties = {{"vis_site_names": {{}}}}
"""
CUP = """<mujoco model="cup"><worldbody><body><body name="object">
<geom name="g0" type="box" size="0.03 0.03 0.02" pos="0 0 0.02" density="500" group="0"/>
</body><site rgba="0 0 0 0" size="0.005" pos="0 0 0" name="bottom_site"/>
<site rgba="0 0 0 0" size="0.005" pos="0 0 0.04" name="top_site"/>
<site rgba="0 0 0 0" size="0.005" pos="0.03 0.03 0" name="horizontal_radius_site"/></body></worldbody></mujoco>
"""
TASK = find_task("libero_goal", 8).bddl.read_text("utf-8")


def run(capsys, *arguments):
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A folder with a task whose bowl is of a category of one's own, and the module that registers it."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    serial = len(list(tmp_path.parent.iterdir()))  # LIBERO keeps what was registered, for the whole process

    def make(name):
        category, folder = f"own_{name}_cup{serial}", tmp_path / "tasks"
        folder.mkdir()
        (folder / f"helper_{category}.py").write_text("SIZE = 1\n")
        text = MODULE.format(name=f"Own{name.capitalize()}Cup", helper=f"helper_{category}")
        text = text.replace("@register_object\n", "").replace("import register_object", "import OBJECTS_DICT")
        (folder / f"{category}.py").write_text(f"{text}\n\nOBJECTS_DICT[{category!r}] = Own{name.capitalize()}Cup\n")
        (folder / "cup.xml").write_text(CUP)
        task = folder / "task.bddl"
        task.write_text(TASK.replace("akita_black_bowl_1 - akita_black_bowl", f"akita_black_bowl_1 - {category}"))
        return task, category

    return make


def test_a_module_beside_the_task_file_registers_its_objects(capsys, project):
    task, module = project("beside")
    status, _, err = run(capsys, "diagnose", str(task))
    assert (status, "error[SIM016]: LIBERO has no category `own_beside" in err) == (MISUSE, True)
    assert f"{task}:" in err
    assert "--import MODULE" in err
    status, out, _ = run(capsys, "diagnose", str(task), "--import", module, "--json")
    assert status == FINDINGS
    assert json.loads(out)["diagnoses"][0]["arguments"] == ["akita_black_bowl_1", "plate_1"]


def test_a_project_lists_its_modules(capsys, project, monkeypatch):
    task, module = project("listed")
    folder = task.parent / "inner"
    folder.mkdir()
    monkeypatch.chdir(folder)
    (task.parent / "pyproject.toml").write_text(f'[tool.onto]\nimports = ["{module}"]\n')
    status, out, _ = run(capsys, "diagnose", str(task), "--json")
    assert (status, len(json.loads(out)["diagnoses"])) == (FINDINGS, 1)
    (task.parent / "pyproject.toml").write_text("[tool.onto]\nimports = 3\n")
    status, _, err = run(capsys, "diagnose", str(task))
    assert (status, "error[SIM024]" in err, "is not a list of module names" in err) == (MISUSE, True, True)


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("x = 1\ny = x +\n", 2, "SyntaxError"),
        ("x = 1\n\ny = unknown\n", 3, "NameError: name 'unknown'"),
        ("import nothing_of_the_kind\n", 1, "No module named 'nothing_of_the_kind'"),
    ],
)
def test_an_error_in_the_module_names_file_and_line(capsys, project, text, line, says):
    task, module = project(f"wrong{line}")
    (task.parent / f"{module}.py").write_text(text)
    status, _, err = run(capsys, "diagnose", str(task), "--import", module)
    assert (status, "error[SIM024]" in err) == (MISUSE, True)
    assert f"{module}.py:{line}" in err
    assert says in err
    assert "Traceback" not in err


def test_a_module_that_is_not_there_is_said(capsys, project):
    task, module = project("there")
    status, _, err = run(capsys, "diagnose", str(task), "--import", module[:-1] + "x")
    assert (status, "error[SIM024]: there is no module" in err) == (MISUSE, True)
    assert f"did you mean `{module}`?" in err


def test_an_error_of_the_class_and_a_missing_file_are_told_apart(capsys, project):
    task, module = project("broken")
    source = task.parent / f"{module}.py"
    source.write_text(source.read_text().replace('self.category_name = "cup"', "self.category_name = nothing"))
    status, _, err = run(capsys, "diagnose", str(task), "--import", module)
    assert (status, "error[SIM016]" in err, "NameError" in err) == (MISUSE, True, True)
    assert f"{module}.py:1" in err
    (task.parent / "cup.xml").unlink()
    status, _, err = run(capsys, "diagnose", str(task), "--import", module)
    assert (status, "error[SIM020]" in err) == (MISUSE, True)
    assert str(task.parent / "cup.xml") in err
    assert f"{module}.py:" in err


def test_objects_without_room_are_named_with_their_region(capsys, tmp_path):
    task = tmp_path / "crowded.bddl"
    task.write_text(
        TASK.replace(
            "(On cream_cheese_1 main_table_cream_cheese_region)", "(On cream_cheese_1 main_table_plate_region)"
        )
    )
    status, _, err = run(capsys, "diagnose", str(task))
    assert status == MISUSE
    says = "two objects have no room in region `main_table_plate_region`: `cream_cheese_1` and `plate_1`"
    assert f"error[SIM016]: {says}" in err
    assert "(On cream_cheese_1 main_table_plate_region)" in err


def test_a_category_that_is_misspelt_is_corrected(capsys, tmp_path):
    task = tmp_path / "misspelt.bddl"
    task.write_text(TASK.replace("wooden_cabinet_1 - wooden_cabinet", "wooden_cabinet_1 - woden_cabinet"))
    status, _, err = run(capsys, "diagnose", str(task))
    assert (status, "did you mean `wooden_cabinet`?" in err) == (MISUSE, True)


@pytest.mark.parametrize("changed", ["cup.xml", "MODULE.py", "helper_MODULE.py", None])
def test_the_scene_cache_notices_what_changed_of_ones_own(project, tmp_path, monkeypatch, changed):
    from runtime.worlds.libero.simulator import compiled
    from runtime.worlds.libero.simulator.own_code import import_own
    from runtime.worlds.libero.simulator.scene_cache import SceneCache

    task, module = project(f"cached{str(changed)[0].lower()}")
    import_own([module], task.parent)
    cache, built = SceneCache(tmp_path / "cache"), []
    build = compiled._build
    monkeypatch.setattr(compiled, "_build", lambda *a, **k: built.append(a) or build(*a, **k))
    first = compiled.compile_scene(task, cache=cache)
    if changed is not None:
        path = task.parent / changed.replace("MODULE", module)
        text = path.read_text()
        path.write_text(text.replace('density="500"', 'density="250"') if changed == "cup.xml" else f"{text}\n# new\n")
    second = compiled.compile_scene(task, cache=cache)
    assert len(built) == (1 if changed is None else 2)
    mass = [scene.model.body_mass[scene.index.bodies("akita_black_bowl_1")].sum() for scene in (first, second)]
    assert mass[1] == pytest.approx(mass[0] * (0.5 if changed == "cup.xml" else 1.0))


def test_an_import_without_libero_s_own_fault_is_no_problem():
    from pathlib import Path

    from runtime.worlds.libero.simulator.own_code import import_own

    import_own(["json"], Path())
    with pytest.raises(OntoError, match="SIM024"):
        import_own(["json.nothing"], Path())
