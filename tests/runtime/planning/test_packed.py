"""Packed networks are the networks that they were."""

from __future__ import annotations

import copy

import pytest
import torch

from grounding.world_model.layers import ensemble_mlp, mlp
from runtime.planning.packed import pack


def filled(network: torch.nn.Module) -> torch.nn.Module:
    torch.manual_seed(0)
    for weight in network.parameters():
        torch.nn.init.normal_(weight, std=0.1)
    return network.requires_grad_(requires_grad=False)


@pytest.mark.parametrize(
    ("network", "shape"),
    [
        (mlp([70, 128, 128, 4]), (9, 70)),
        (mlp([70, 128, 128, 4]), (2, 9, 5, 70)),
        (ensemble_mlp(3, [30, 192, 192, 4]), (3, 300, 30)),
        (ensemble_mlp(3, [30, 192, 192, 4]), (3, 1, 30)),
    ],
)
def test_it_computes_what_it_computed(network, shape):
    network = filled(network)
    packed = pack(torch.nn.ModuleList([copy.deepcopy(network)]))[0]
    rows = torch.randn(shape)
    with torch.no_grad():
        assert torch.allclose(packed(rows), network(rows), atol=1e-5)
        turned = rows.transpose(0, 1).contiguous().transpose(0, 1)
        assert torch.allclose(packed(turned), network(rows), atol=1e-5)


def test_a_gradient_is_that_of_the_network():
    network = filled(ensemble_mlp(2, [30, 128, 128, 4]))
    rows = torch.randn(2, 7, 30)
    gradients = []
    for each in (network, pack(torch.nn.ModuleList([copy.deepcopy(network)]))[0]):
        given = rows.clone().requires_grad_(requires_grad=True)
        each(given).square().sum().backward()
        gradients.append(given.grad)
    assert torch.equal(*gradients)
    assert float(gradients[0].abs().max()) > 0


def test_networks_without_a_large_layer_stay_as_they_were():
    network = pack(torch.nn.ModuleList([filled(ensemble_mlp(2, [30, 16, 4]))]))
    assert isinstance(network[0], torch.nn.Sequential)


def test_other_networks_stay_as_they_were():
    network = torch.nn.Sequential(torch.nn.Linear(128, 128), torch.nn.Tanh(), torch.nn.Linear(128, 4))
    assert isinstance(pack(torch.nn.ModuleList([network]))[0], torch.nn.Sequential)


@pytest.mark.skipif(not hasattr(torch.ops.mkldnn, "_linear_pointwise"), reason="torch was built without oneDNN")
def test_networks_with_a_large_layer_are_packed():
    network = pack(torch.nn.ModuleList([filled(ensemble_mlp(2, [30, 192, 192, 4]))]))
    assert type(network[0]).__name__ == "_Packed"


def test_what_torch_cannot_pack_stays_as_it_was(monkeypatch):
    monkeypatch.setattr(torch.ops, "mkldnn", object())
    network = pack(torch.nn.ModuleList([filled(mlp([128, 128, 128]))]))
    assert isinstance(network[0], torch.nn.Sequential)
