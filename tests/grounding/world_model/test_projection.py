"""A projection keeps the directions in which training features vary, and comes back as it was saved."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from grounding.world_model.checkpoint import Card, load, save
from grounding.world_model.encoder import encoder
from grounding.world_model.projection import Projected, fit, load_projected, save_projection
from onto_compiler.problems import OntoError


def codes(error):
    return [problem.code for problem in error.value.problems]


def cloud(rows, width, rank, seed=0):
    """Features (rows, width) that vary in ``rank`` directions, each less than the one before."""
    random = np.random.default_rng(seed)
    axes = np.linalg.qr(random.normal(size=(width, rank)))[0]
    lengths = 3.0 * 0.7 ** np.arange(rank)
    return (5 + random.normal(size=(rows, rank)) * lengths @ axes.T).astype(np.float32)


@pytest.mark.parametrize("whitened", [False, True])
def test_components_are_uncorrelated_by_falling_variance(whitened):
    features = cloud(5000, 20, 20)
    found = fit(features, 6, whitened=whitened)
    spread = np.cov(found(features).T)
    assert np.allclose(spread - np.diag(np.diag(spread)), 0, atol=1e-3)
    assert np.allclose(found(features).mean(axis=0), 0, atol=1e-3)
    if whitened:
        assert np.allclose(np.diag(spread), 1, atol=1e-3)
    else:
        assert (np.diff(np.diag(spread)) < 0).all()
        assert np.allclose(found.axes.T @ found.axes, np.eye(6), atol=1e-5)


def test_all_the_variance_is_kept_where_there_is_no_more():
    features = cloud(300, 30, 4)
    found = fit(features, 4)
    assert found.share == pytest.approx(1, abs=1e-6)
    assert np.allclose(found(features) @ found.axes.T + found.mean, features, atol=1e-4)
    assert fit(features, 2).share < 0.95


def test_what_is_kept_is_what_numpy_calls_the_first_singular_directions():
    features = cloud(400, 12, 12)
    found = fit(features, 5)
    centred = features.astype(np.float64) - features.mean(axis=0, dtype=np.float64)
    _, lengths, directions = np.linalg.svd(centred, full_matrices=False)
    assert np.allclose(np.abs(directions[:5] @ found.axes), np.eye(5), atol=1e-4)
    assert found.share == pytest.approx((lengths[:5] ** 2).sum() / (lengths**2).sum())


def test_with_fewer_rows_than_features_it_is_the_same_by_products_of_rows():
    features = cloud(60, 200, 12)
    found = fit(features, 20)  # more than vary: the rest is rounding
    centred = features.astype(np.float64) - features.mean(axis=0, dtype=np.float64)
    _, lengths, directions = np.linalg.svd(centred, full_matrices=False)
    assert np.allclose(np.abs(directions[:12] @ found.axes[:, :12]), np.eye(12), atol=1e-3)
    assert np.allclose(found.axes.T @ found.axes, np.eye(20), atol=1e-5)
    assert found.share == pytest.approx((lengths[:20] ** 2).sum() / (lengths**2).sum())
    assert np.allclose(fit(np.vstack([features] * 4), 12).axes, found.axes[:, :12], atol=1e-3)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 1000), order=st.permutations(range(60)))
def test_the_order_of_the_rows_does_not_matter(seed, order):
    features = cloud(60, 8, 3, seed)
    assert np.allclose(fit(features, 3).axes, fit(features[list(order)], 3).axes, atol=1e-4)


def test_a_component_that_does_not_vary_is_not_scaled_up():
    features = cloud(200, 10, 2)
    found = fit(features, 5, whitened=True)
    assert np.isfinite(found.axes).all()
    assert np.abs(found(features)[:, 2:]).max() < 1e-3
    constant = fit(np.ones((10, 4), dtype=np.float32), 2, whitened=True)
    assert np.array_equal(constant(np.ones((3, 4), dtype=np.float32)), np.zeros((3, 2)))


@pytest.mark.parametrize("components", [0, 5, 11, -1])
def test_more_components_than_the_data_have_are_refused(components):
    with pytest.raises(OntoError, match=f"{components} components cannot be had from 5 rows of 10 features") as error:
        fit(cloud(5, 10, 3), components)
    assert codes(error) == ["WM010"]


def test_features_that_are_not_finite_are_neither_fitted_nor_projected():
    features = cloud(20, 4, 2)
    found = fit(features, 2)
    features[7, 1] = np.nan
    for use in (found, lambda features: fit(features, 2)):
        with pytest.raises(OntoError, match="the first of them row 7") as error:
            use(features)
        assert codes(error) == ["WM010"]


def test_features_of_another_width_are_refused():
    with pytest.raises(OntoError, match=r"\(N, 4\) are expected") as error:
        fit(cloud(20, 4, 2), 2)(cloud(20, 5, 2))
    assert codes(error) == ["WM010"]


@pytest.fixture(scope="module")
def pictures():
    return np.random.default_rng(0).integers(0, 256, (1100, 16, 16, 3), dtype=np.uint8)


@pytest.fixture(scope="module")
def projected(pictures):
    base = encoder("pixels:4:16")
    return Projected(base, fit(base.encode(pictures[:200]), 10, whitened=True))


def test_an_encoder_with_a_projection_is_an_encoder(projected, pictures):
    assert (projected.name, projected.size, projected.shape) == ("pixels:4:16>10", 16, (10,))
    expected = projected.projection(projected.encoder.encode(pictures))
    found = projected.encode(pictures)
    assert found.dtype == np.float32
    assert np.allclose(found, expected, atol=1e-5)
    assert projected.encode(pictures[:0]).shape == (0, 10)
    with pytest.raises(OntoError, match="WM009"):
        projected.encode(pictures[:, :8])


def test_its_identity_follows_encoder_and_projection(projected, pictures):
    other = Projected(encoder("pixels:2:32"), projected.projection)
    moved = replace(projected.projection, mean=projected.projection.mean + 1)
    assert len({projected.identity, other.identity, Projected(projected.encoder, moved).identity}) == 3


def test_a_projection_comes_back_with_its_encoder(projected, pictures, tmp_path):
    path = tmp_path / "projection.safetensors"
    save_projection(path, projected, Card("", seed=3, command="onto train projection"))
    again = load_projected(path)
    assert again.identity == projected.identity
    assert again.name == projected.name
    assert (again.projection.whitened, again.projection.share) == (True, projected.projection.share)
    assert np.array_equal(again.encode(pictures), projected.encode(pictures))
    card = load(path, "projection").card
    assert (card.encoder, card.seed, card.command) == (projected.encoder.identity, 3, "onto train projection")


def test_a_projection_of_other_weights_is_refused(projected, tmp_path):
    path = tmp_path / "projection.safetensors"
    save_projection(path, projected, Card(""))
    found = load(path, "projection")
    save(path, found.tensors, replace(found.card, encoder="0" * 64))
    with pytest.raises(OntoError, match="it reads features 000000000000, and `pixels:4:16` gives") as error:
        load_projected(path)
    assert codes(error) == ["WM011"]


@pytest.mark.parametrize(
    "tensors",
    [{"mean": torch.zeros(3)}, {"mean": torch.zeros(3), "axes": torch.zeros(4, 2)}, {"mean": torch.tensor(0.0)}],
)
def test_arrays_that_do_not_belong_together_are_refused(tensors, tmp_path):
    path = tmp_path / "projection.safetensors"
    save(path, tensors, Card("projection", {"encoder": "pixels:4:16"}))
    with pytest.raises(OntoError) as error:
        load_projected(path)
    assert codes(error) == ["WM004"]


def test_a_card_that_names_no_encoder_is_refused(tmp_path):
    path = tmp_path / "projection.safetensors"
    save(path, {"mean": torch.zeros(3), "axes": torch.zeros(3, 2)}, Card("projection"))
    with pytest.raises(OntoError) as error:
        load_projected(path)
    assert codes(error) == ["WM007"]
