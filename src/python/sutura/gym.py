"""Gymnasium environments: a needle to be driven through two lips, a thread to be pulled taut.

    import gymnasium, sutura.gym
    env = gymnasium.make("sutura/DriveNeedle-v0")

Lengths in observations are millimetres, forces newtons: numbers of the order of one.
"""

from __future__ import annotations

from typing import Any, ClassVar

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .scene import Scene
from .simulation import Simulation

Vector = NDArray[np.float64]

MM = 1e-3
STEPS = 400  #: that an episode has at most, of 10 ms
MOST = 1000.0  #: of any observation; beyond it is cut off
TEAR = 1.0  #: N, of any hand: the tissue tears


def wound(thread_length: float) -> Scene:
    """Two lips of skin, 2 mm apart, a 17 mm 3/8 needle with a thread (length in m), three hands:
    one at the needle's end, one for its tip, one at the end of the thread."""
    scene = Scene(plugins=["thread", "tissue", "suturing", "tools", "output"], dt="10 ms")
    skin = scene.node("skin")
    skin.add("BlockMesh", box="-9 -4 -6  9 4 0 mm", cells="18 4 3", holes="-1 -4 -4  1 4 0 mm")
    skin.add("Tissue", young="40 kPa", poisson=0.4, density=1000, damping_stiffness="10 ms",
             element="t4")
    skin.add("Attach", box="-9 -4 -6  9 4 -6 mm")
    left = skin.add("TissueProbe", name="left", point="-1 0 0 mm")
    right = skin.add("TissueProbe", name="right", point="1 0 0 mm")
    scene.add("SutureThread", name="suture", needle="17 mm 3/8 circle", thread="6-0 nylon",
              thread_length=thread_length, thread_beams=round(thread_length / 2e-3),
              needle_centre="0 0 5 mm", tip_angle="-60 deg", plane_normal="0 -1 0",
              thread_direction="-1 0 1", damping_mass="2 1/s")
    hand = scene.add("Track", name="hand", about="suture", times=0, turns=0)
    rest = scene.add("Track", name="rest", times=0)
    scene.add("Grasper", name="holder", at="15 mm", track=hand)
    scene.add("Grasper", name="puller", at="1 mm", track=hand, grasp="1000 s")
    scene.add("Grasper", name="tail", at=0.016 + thread_length, track=rest, rotation_stiffness=0)
    scene.add("Puncture", threshold="0.2 N", friction=0.2)
    scene.add("Cutting", threshold="0.05 N")
    scene.add("SuturePath", spacing="1 mm")
    scene.add("PathFriction", coefficient=0.1, pressure="10 kPa")
    scene.add("Distance", name="gap", **{"from": left, "to": right})
    return scene


class _Task(gymnasium.Env[Vector, Vector]):
    """What both have in common. Actions are numbers from -1 to 1."""

    metadata: dict[str, Any] = {"render_modes": ["svg"], "render_fps": 100}

    def __init__(self, actions: int, observations: int, render_mode: str | None = None):
        self.render_mode = render_mode
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (actions,), np.float64)
        self.observation_space = gymnasium.spaces.Box(-MOST, MOST, (observations,), np.float64)
        self.sim = self._simulation()
        self._left = STEPS

    def _simulation(self) -> Simulation:
        raise NotImplementedError

    def _begin(self) -> None:
        """Back to the start, a little different each time (self.np_random)."""
        raise NotImplementedError

    def _act(self, action: Vector) -> None:
        """Moves the hand; the step comes after."""
        raise NotImplementedError

    def _observe(self) -> Vector:
        raise NotImplementedError

    def _judge(self) -> tuple[float, bool]:
        """Reward of the step, and whether the task is done."""
        raise NotImplementedError

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[Vector, dict[str, Any]]:
        super().reset(seed=seed)
        self._left = STEPS
        self._begin()
        return self._seen(), {}

    def step(self, action: Vector) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        self._act(np.clip(action, -1.0, 1.0))
        report = self.sim.step()
        self._left -= 1
        reward, done = self._judge()
        torn = self._force() > TEAR
        if torn:
            reward -= 10.0
        info = {"success": done and not torn, "torn": torn, "solved": report.solved}
        return self._seen(), reward, done or torn, self._left <= 0, info

    def _seen(self) -> Vector:
        return np.clip(self._observe(), -MOST, MOST)

    def _force(self) -> float:
        """The largest of the hands (N)."""
        return max(float(np.linalg.norm(self.sim[f"/{h}.force"]))
                   for h in ("holder", "puller", "tail"))

    def _share(self) -> float:
        return self._left / STEPS

    def render(self) -> str | None:
        """The picture as SVG, with render_mode "svg"."""
        return self.sim.picture() if self.render_mode == "svg" else None

    def close(self) -> None:
        self.sim.close()


class DriveNeedle(_Task):
    """Drive the needle through both lips until its tip is 1 mm above the skin on the far side.

    action       advance of the needle along its arc (1: 2 degrees), shift of its centre along x and
                 z (1: 0.1 mm)
    observation  tip (3), direction in which it points (3), force of the hand (3), angle advanced
                 (radians), length inserted, number of punctures, share of the time left
    reward       what the angle has gained of the 130 degrees that it takes, less 0.01 per newton;
                 10 for the end, -10 for tearing (a force above 1 N)
    """

    WAY = np.radians(130)

    def __init__(self, render_mode: str | None = None):
        super().__init__(3, 13, render_mode)
        self._angle = self._gained = 0.0
        self._centre: Vector = np.zeros(3)

    def _simulation(self) -> Simulation:
        return wound(0.15).load(on_message=lambda kind, sentence: None)

    def _begin(self) -> None:
        self.sim.reset()
        self._angle = 0.0
        offset = self.np_random.uniform(-0.3, 0.3, 2) * MM
        self._centre = np.asarray(self.sim["/hand.position"]) + [offset[0], 0.0, offset[1]]
        self._act(np.zeros(3))
        self.sim.step()

    def _act(self, action: Vector) -> None:
        self._gained = float(action[0]) * np.radians(2)
        self._angle += self._gained
        self._centre = self._centre + 0.1 * MM * np.array([action[1], 0.0, action[2]])
        self.sim["/hand.position"] = self._centre
        self.sim["/hand.rotation"] = [0.0, -self._angle, 0.0]

    def _observe(self) -> Vector:
        sim = self.sim
        points = sim["/suture"].positions
        along = points[0] - points[1]
        return np.concatenate([
            points[0] / MM, along / np.linalg.norm(along), sim["/holder.force"],
            [self._angle, sim["/suture_path.inserted_length"] / MM, sim["/puncture.punctures"],
             self._share()]])

    def _judge(self) -> tuple[float, bool]:
        tip = np.asarray(self.sim["/suture.tip_position"]) / MM
        through = bool(self.sim["/puncture.punctures"] >= 2 and tip[0] > 2 and tip[2] > 1)
        reward = self._gained / self.WAY - 0.01 * self._force()
        return reward + (10.0 if through else 0.0), through


class PullTaut(_Task):
    """The needle is through and out; pull its thread until the lips are closed to 0.5 mm, without
    tearing. The end of the thread is held.

    action       velocity of the hand (1: 50 mm/s along x, y, z)
    observation  where the hand is from where it began (3), its force (3), that at the end of the
                 thread (3), gap between the lips, force of the thread on its path across, share
                 of the time left
    reward       millimetres by which the gap has closed, less 0.01 per newton; 10 for the end,
                 -10 for tearing (a force above 1 N)
    """

    CLOSED = 0.5  #: mm
    _ready: ClassVar[bytes | None] = None  # made once in a process: some seconds

    def __init__(self, render_mode: str | None = None):
        super().__init__(3, 12, render_mode)
        self._begun: Vector = np.zeros(3)
        self._gap = 0.0

    def _simulation(self) -> Simulation:
        sim = wound(0.15).load(on_message=lambda kind, sentence: None)
        if PullTaut._ready is None:
            PullTaut._ready = _stitched(sim)
        return sim

    def _begin(self) -> None:
        assert PullTaut._ready is not None
        self.sim.restore(PullTaut._ready)
        self._begun = np.asarray(self.sim["/hand.position"])
        sideways = self.np_random.uniform(-0.3, 0.3, 3) * MM
        self.sim["/hand.position"] = self._begun + sideways
        self.sim.step()
        self._gap = float(self.sim["/gap.distance"]) / MM

    def _act(self, action: Vector) -> None:
        here = np.asarray(self.sim["/hand.position"])
        self.sim["/hand.position"] = here + 0.5 * MM * action

    def _observe(self) -> Vector:
        sim = self.sim
        return np.concatenate([
            (np.asarray(sim["/hand.position"]) - self._begun) / MM, sim["/puller.force"],
            sim["/tail.force"],
            [self._gap, sim["/suture_path.lateral_force"], self._share()]])

    def _judge(self) -> tuple[float, bool]:
        before, self._gap = self._gap, float(self.sim["/gap.distance"]) / MM
        closed = self._gap < self.CLOSED
        return before - self._gap - 0.01 * self._force() + (10.0 if closed else 0.0), closed


def _stitched(sim: Simulation) -> bytes:
    """The state in which the needle has been turned through and out of the lips by its tip."""
    def turn(begin: int, end: int) -> None:
        for angle in range(begin, end + 1, 2):
            sim["/hand.rotation"] = [0.0, -np.radians(angle), 0.0]
            sim.step()

    turn(0, 130)
    sim["/puller.hold"] = 1
    sim["/holder.hold"] = 0
    turn(130, 250)
    return sim.save()


for _name in ("DriveNeedle", "PullTaut"):
    gymnasium.register(id=f"sutura/{_name}-v0", entry_point=f"sutura.gym:{_name}")
