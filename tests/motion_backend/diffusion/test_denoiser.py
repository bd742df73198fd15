"""What LINGO's appendix prints of its networks: tokens, sizes, masks, clean history, frame numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from motion_backend.diffusion.completion_scheduler import SCHEDULER_PRESETS, CompletionScheduler, SchedulerSizes
from motion_backend.diffusion.conditions import Conditions, FramedText
from motion_backend.diffusion.denoiser import PRESETS, Denoiser, DenoiserSizes
from motion_backend.diffusion.motion_features import FEATURES, HISTORY, RATE, WINDOW
from motion_backend.diffusion.noise_schedule import NoiseSchedule
from motion_backend.diffusion.sampler import Sampler, Scale
from motion_backend.diffusion.scene_encoder import SceneEncoder, SceneSizes, voxel_image
from motion_backend.diffusion.transformer import Layer

TINY = DenoiserSizes(2, 2, 16, 16, True, SceneSizes(1, 2, 16, 16))
PLAIN = Scale(torch.zeros(FEATURES), torch.ones(FEATURES))


def told(count: int = 3) -> Conditions:
    """Conditions of which nothing is masked."""
    made = torch.Generator().manual_seed(1)
    ones = torch.ones(count)
    return Conditions(
        torch.randn(count, 384, generator=made), ones, torch.arange(count) * 30, torch.ones(count, dtype=torch.int64),
        torch.ones(count, dtype=torch.int64),
        torch.randn(count, 9, generator=made), ones, torch.randn(count, 4, generator=made), ones,
        (torch.rand(count, 64, 32, 32, generator=made) < 0.2).float(), ones,
    )  # fmt: skip


def network(sizes: DenoiserSizes = TINY) -> Denoiser:
    torch.manual_seed(0)
    return Denoiser(sizes).eval()


def test_the_paper_preset_has_the_printed_sizes() -> None:
    paper, scheduler = PRESETS["paper"], SCHEDULER_PRESETS["paper"]
    assert (paper.layers, paper.heads, paper.width, paper.norm_first) == (8, 16, 512, False)
    assert paper.scene is not None
    assert (paper.scene.layers, paper.scene.heads, paper.scene.width) == (6, 16, 512)
    assert (scheduler.layers, scheduler.heads, scheduler.width) == (3, 8, 512)
    assert (WINDOW, HISTORY, RATE, FEATURES) == (16, 2, 10, 3 + 22 * 6 + 21 * 3 + 4)


def test_twenty_tokens_with_positions_go_through_the_transformer() -> None:
    net, seen = network(), []
    net.encoder.register_forward_pre_hook(lambda _module, given: seen.append(given[0]))
    given = told()
    tokens = net.encode(given)
    assert tokens.shape == (3, 4, 16)
    net(torch.zeros(3, WINDOW, FEATURES), torch.zeros(3), tokens)
    assert seen[0].shape == (3, 20, 16)
    assert net.positions.shape == (20, 16)
    assert len({tuple(row) for row in net.positions.tolist()}) == 20


def test_the_step_is_added_to_the_condition_tokens_alone() -> None:
    net, seen = network(), []
    net.encoder.register_forward_pre_hook(lambda _module, given: seen.append(given[0]))
    tokens = net.encode(told())
    for step in (3.0, 90.0):
        net(torch.zeros(3, WINDOW, FEATURES), torch.full((3,), step), tokens)
    change = (seen[1] - seen[0]).detach()
    assert torch.equal(change[:, 4:], torch.zeros_like(change[:, 4:]))
    assert torch.allclose(change[:, :1].expand(-1, 4, -1), change[:, :4], atol=1e-6)
    assert change[:, :4].abs().min() > 0


@pytest.mark.parametrize("name", ["hand", "pelvis", "scene"])
def test_a_masked_condition_is_a_token_of_zeros(name: str) -> None:
    net, place = network(), {"scene": 0, "hand": 2, "pelvis": 3}[name]
    open_, masked = net.encode(told()), net.encode(told().without(name))
    assert torch.equal(masked[:, place], torch.zeros(3, 16))
    assert open_[:, place].abs().sum() > 0
    others = [index for index in range(4) if index != place]
    assert torch.equal(open_[:, others], masked[:, others])


def test_masked_text_still_tells_the_frame_number() -> None:
    torch.manual_seed(0)
    text = FramedText(16)
    words, none = torch.randn(2, 384), torch.zeros(2)
    masked = text(words, none, torch.tensor([30, 30]))
    assert torch.equal(masked[0], masked[1])
    assert not torch.equal(masked, text(words, none, torch.tensor([60, 60])))


def test_the_frame_number_is_told_in_the_text_token_alone() -> None:
    """LINGO A.3: added to the sentence; zero in locomotion, which leaves the same token at every moment."""
    net, given = network(), told()
    later = net.encode(replace(given, frame=given.frame + 42))
    changed = (later - net.encode(given)).detach().abs().amax(dim=2)
    assert torch.equal(changed[:, [0, 2, 3]], torch.zeros(3, 3))
    assert changed[:, 1].min() > 0
    still = given.without("frame")
    assert torch.equal(still.frame, torch.zeros_like(given.frame))


def test_history_comes_out_as_it_went_in() -> None:
    net, noised = network(), torch.randn(3, WINDOW, FEATURES)
    found = net(noised, torch.zeros(3), net.encode(told()))
    assert found.shape == noised.shape
    assert torch.equal(found[:, :HISTORY], noised[:, :HISTORY])
    assert not torch.equal(found[:, HISTORY:], noised[:, HISTORY:])


@pytest.mark.parametrize(("steps", "fresh"), [(100, True), (10, True), (10, False)])
def test_history_is_clean_at_every_step_of_sampling(steps: int, fresh: bool) -> None:
    """With DDPM's hundred steps, and with ten of DDIM with and without fresh noise."""
    net, seen = network(replace(TINY, scene=None)), []
    net.register_forward_pre_hook(lambda _module, given: seen.append((given[0][:, :HISTORY].clone(), given[1])))
    history = np.random.default_rng(0).normal(size=(2, HISTORY, FEATURES))
    sampler = Sampler(net, PLAIN, steps=steps, fresh=fresh)
    found = sampler.windows(history, told(2), 7)
    assert found.shape == (2, WINDOW - HISTORY, FEATURES)
    assert [int(step[0]) for _, step in seen] == list(NoiseSchedule().spaced(steps))
    for first, _ in seen:
        assert np.allclose(first.numpy(), history, atol=1e-6)
    assert np.array_equal(found, sampler.windows(history, told(2), 7))
    assert not np.array_equal(found, sampler.windows(history, told(2), 8))


def test_voxels_of_another_shape_are_refused() -> None:
    assert voxel_image(np.zeros((2, 32, 32, 32), dtype=np.bool_)).shape == (64, 32, 32)
    with pytest.raises(ValueError, match=r"\(2, 32, 32, 32\), not \(2, 16, 32, 32\)"):
        voxel_image(np.zeros((2, 16, 32, 32), dtype=np.bool_))


def test_the_scene_is_read_from_sixteen_patches_and_one_token_more() -> None:
    encoder, seen = SceneEncoder(SceneSizes(1, 2, 16, 16), 24), []
    encoder.encoder.register_forward_pre_hook(lambda _module, given: seen.append(given[0].shape))
    assert encoder(torch.zeros(3, 64, 32, 32)).shape == (3, 24)
    assert seen == [(3, 17, 16)]


@pytest.mark.parametrize("norm_first", [True, False])
def test_a_layer_is_that_of_torch(norm_first: bool) -> None:
    """An oracle that others wrote: the same weights in torch's own layer give the same answer."""
    torch.manual_seed(0)
    ours, theirs = (
        Layer(16, 4, 32, norm_first),
        torch.nn.TransformerEncoderLayer(
            16,
            4,
            32,
            0.0,
            lambda x: torch.nn.functional.gelu(x, approximate="tanh"),
            batch_first=True,
            norm_first=norm_first,
        ),
    )
    theirs.self_attn.in_proj_weight.data = ours.queries_keys_values.weight.data
    theirs.self_attn.in_proj_bias.data = ours.queries_keys_values.bias.data
    theirs.self_attn.out_proj = ours.joined
    theirs.linear1, theirs.linear2, theirs.norm1, theirs.norm2 = (
        ours.wider, ours.narrower, ours.first_norm, ours.second_norm,
    )  # fmt: skip
    x = torch.randn(2, 5, 16)
    assert torch.allclose(ours(x), theirs(x), atol=1e-5)


def test_the_scheduler_answers_with_a_share() -> None:
    torch.manual_seed(0)
    scheduler, seen = CompletionScheduler(SchedulerSizes(1, 2, 16, 16)), []
    scheduler.encoder.register_forward_pre_hook(lambda _module, given: seen.append(given[0].shape))
    found = scheduler(torch.randn(3, WINDOW, FEATURES), torch.randn(3, 384), torch.tensor([0, 60, 300]))
    assert seen == [(3, 1 + WINDOW, 16)]
    assert found.shape == (3,)
    assert ((found > 0) & (found < 1)).all()
