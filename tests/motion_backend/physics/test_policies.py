"""Five policies that see what the paper lets them see."""

from __future__ import annotations

import torch
from for_each import for_each

from motion_backend.backend_protocol import Part, PartKind
from motion_backend.motion import Action, Emotion, Skill
from motion_backend.physics.policies import PLAN_SIZE, POLICY_OF, WITH_TEXT, PolicyConfig, PolicyName, five_policies
from motion_backend.physics.policy_view import policy_of

SIZES = (217 + 30 + PLAN_SIZE, 625, 60, 64)
ACTIONS = 30


def test_every_skill_has_one_of_five_policies() -> None:
    assert set(POLICY_OF) == set(Skill)
    assert set(POLICY_OF.values()) == set(PolicyName)
    assert [name.value for name in PolicyName] == ["w", "s", "l", "r", "g"]


def test_walk_sit_and_lie_alone_are_told_words() -> None:
    policies = five_policies(ACTIONS, seed=0)
    for name, policy in policies.items():
        assert policy.input_sizes == (*SIZES[:3], SIZES[3] if name in WITH_TEXT else 0)
        assert policy(torch.randn(2, sum(policy.input_sizes))).shape == (2, ACTIONS)
    assert {PolicyName.REACH, PolicyName.GETUP} == set(PolicyName) - WITH_TEXT


def test_a_new_policy_does_next_to_nothing_and_heeds_everything_it_sees() -> None:
    policy = five_policies(ACTIONS, seed=0)[PolicyName.SIT]
    seen = torch.randn(4, sum(SIZES), requires_grad=True)
    acted = policy(seen)
    assert acted.abs().max() < 0.1
    (slope,) = torch.autograd.grad(acted.abs().sum(), seen)
    assert all(part.abs().max() > 0 for part in slope.split(SIZES, dim=-1))


def test_the_same_seed_gives_the_same_policies() -> None:
    one, same, other = (five_policies(ACTIONS, seed)[PolicyName.WALK].state_dict() for seed in (0, 0, 1))
    assert all(torch.equal(one[name], same[name]) for name in one)
    assert any(not torch.equal(one[name], other[name]) for name in one)


def test_all_five_together_are_small() -> None:
    numbers = sum(one.numel() for policy in five_policies(ACTIONS, 0).values() for one in policy.parameters())
    assert 2 * numbers < 8e6, "bytes in half precision"


@for_each(
    ("kind", "skill", "name"),
    [
        (PartKind.WALK, Skill.SITDOWN, PolicyName.WALK),
        (PartKind.TURN, Skill.TOUCH, PolicyName.WALK),
        (PartKind.RISE, Skill.STANDUP, PolicyName.GETUP),
        (PartKind.RISE, Skill.LOCO, PolicyName.GETUP),
        (PartKind.SIT, Skill.SITDOWN, PolicyName.SIT),
        (PartKind.HOLD, Skill.LIEDOWN, PolicyName.LIE),
        (PartKind.REACH, Skill.TOUCH, PolicyName.REACH),
        (PartKind.HOLD, Skill.LOCO, None),
    ],
)
def test_every_part_but_standing_is_one_policys(kind: PartKind, skill: Skill, name: PolicyName | None) -> None:
    assert policy_of(Part(kind, Action(skill, "x", Emotion.NEUTRAL))) is name


def test_a_policy_has_the_papers_two_layers() -> None:
    assert PolicyConfig.of(PolicyName.WALK, 3).hidden == (512, 256)
