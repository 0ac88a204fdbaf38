"""Films of a real scene: they show and tell what the demonstration did."""

import numpy as np
import pytest

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def shot():
    from pathlib import Path

    from onto_compiler.knowledge import load_knowledge
    from runtime.worlds.libero.demos.read import load
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.training.film import Filmer
    from runtime.worlds.libero.training.scene import scene_facts
    from runtime.worlds.pictures import backend

    if backend() is None:
        pytest.skip("this machine cannot draw")
    knowledge = load_knowledge()
    sample = Path(__file__).resolve().parents[5] / "docs/examples/put_the_bowl_on_the_plate_demo.hdf5"
    demo = load(sample).demos[0]
    asked = scene_facts(knowledge)
    filmer = Filmer(find_task("libero_goal", "put_the_bowl_on_the_plate"), asked, knowledge, exact=True)
    yield demo, asked, filmer
    filmer.close()


def test_a_film_is_of_the_recorded_moments_and_its_labels_are_the_native_verdict(shot):
    from runtime.worlds.libero.training.hand import sensed

    demo, asked, filmer = shot
    film = filmer.film(demo.start, np.asarray(demo.actions))
    recorded = sensed(*(demo.obs[key] for key in ("ee_pos", "ee_ori", "gripper_states")))
    # Recorded on a processor of another maker, whose sums may differ in the last digit.
    assert np.allclose(film.proprio[2 : len(demo)], recorded[2:], rtol=0, atol=1e-5)
    place = asked.names.index("on(akita_black_bowl_1, plate_1)")
    marks = np.arange(len(film.truth)) * 5
    held = film.truth[:, place]
    assert asked.goals[8] == (place,)
    # The goal may come true, be undone and come true again before the end; it never does before its first time.
    assert not held[marks < demo.origin.success_step].any()
    assert held[-1]
    assert film.pictures.shape == (len(marks), 128, 128, 3)
    assert np.abs(np.diff(film.pictures.astype(int), axis=0)).mean(axis=(1, 2, 3)).min() > 0.01
    assert bool((film.margin[held, place] >= 0).all())

    later = filmer.film(demo.start, np.asarray(demo.actions[:25]), 20)
    assert np.array_equal(later.proprio, film.proprio[20:26])
    assert np.array_equal(later.margin, film.margin[4:6])
    assert np.array_equal(later.pictures, film.pictures[4:6])


def test_the_ten_tasks_ask_for_facts_of_one_scene(shot):
    _, asked, _ = shot
    assert len(asked.goals) == 10
    assert len({place for places in asked.goals.values() for place in places}) == 10
    assert len(asked.names) == 21
    assert len(asked.positive) == 11
    assert all(set(asked.goals[index]) <= set(asked.needed[index]) for index in asked.goals)
    opened = asked.names.index("joint_state(wooden_cabinet_1_top_region, wooden_cabinet_open)")
    assert [index for index, needed in asked.needed.items() if opened in needed] == [3]
