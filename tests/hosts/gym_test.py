"""The Gymnasium environments: spaces, repeatability, and that simple hands reach the end.

Where Gymnasium is installed its own checker and its workers are run too. Debian has no package of
it: a stand-in of a few lines then serves for the rest.
"""

import importlib.util
import sys
import types
import unittest

import numpy as np

HAS_GYMNASIUM = importlib.util.find_spec("gymnasium") is not None
if not HAS_GYMNASIUM:
    class Env:
        def __class_getitem__(cls, _):
            return cls

        def reset(self, *, seed=None):
            if seed is not None or not hasattr(self, "np_random"):
                self.np_random = np.random.default_rng(seed)

    class Box:
        def __init__(self, low, high, shape, dtype):
            self.low, self.high, self.shape, self.dtype = low, high, shape, dtype

        def contains(self, x):
            return (x.shape == self.shape and x.dtype == self.dtype and
                    bool(((x >= self.low) & (x <= self.high)).all()))

    stand_in = types.ModuleType("gymnasium")
    stand_in.Env, stand_in.register = Env, lambda **_: None
    stand_in.spaces = types.SimpleNamespace(Box=Box)
    sys.modules["gymnasium"] = stand_in

from sutura import gym  # noqa: E402

#: An action with which each task is done.
HANDS = {gym.DriveNeedle: [0.5, 0, 0], gym.PullTaut: [0, 0, 0.2]}


def episode(env, action, seed):
    """Observations, rewards, and what the last step says."""
    seen, rewards = [env.reset(seed=seed)[0]], []
    while True:
        observation, reward, ended, cut, info = env.step(np.array(action, dtype=float))
        seen.append(observation)
        rewards.append(reward)
        if ended or cut:
            return np.array(seen), rewards, info


class Tasks(unittest.TestCase):
    def test_a_simple_hand_reaches_the_end(self):
        for kind, action in HANDS.items():
            env = kind()
            seen, rewards, info = episode(env, action, seed=1)
            self.assertTrue(info["success"], kind.__name__)
            self.assertGreater(sum(rewards), 10)
            self.assertTrue(all(env.observation_space.contains(o) for o in seen))
            env.close()

    def test_the_same_seed_gives_the_same_bits(self):
        for kind, action in HANDS.items():
            env, other = kind(), kind()
            first = episode(env, action, seed=3)[0]
            episode(env, action, seed=4)
            np.testing.assert_array_equal(episode(env, action, seed=3)[0], first)
            np.testing.assert_array_equal(episode(other, action, seed=3)[0], first)
            self.assertFalse(np.array_equal(episode(env, action, seed=4)[0][0], first[0]))

    def test_too_hard_tears(self):
        env = gym.PullTaut()
        _, rewards, info = episode(env, [0, 0, -1], seed=1)  # down into the tissue
        self.assertTrue(info["torn"] and not info["success"], info)
        self.assertLess(rewards[-1], -5)

    def test_time_is_up(self):
        env = gym.DriveNeedle()
        seen, _, info = episode(env, [0, 0, 0], seed=1)
        self.assertEqual(len(seen), gym.STEPS + 1)
        self.assertFalse(info["success"])

    def test_picture(self):
        env = gym.DriveNeedle(render_mode="svg")
        env.reset(seed=0)
        self.assertTrue(env.render().startswith("<svg"))


@unittest.skipUnless(HAS_GYMNASIUM, "Gymnasium is not installed")
class Official(unittest.TestCase):
    def test_checker(self):
        from gymnasium.utils.env_checker import check_env
        for kind in HANDS:
            check_env(kind(render_mode="svg"))

    def test_workers(self):
        import gymnasium
        envs = gymnasium.make_vec("sutura/DriveNeedle-v0", num_envs=2,
                                  vectorization_mode="async")
        first, _ = envs.reset(seed=[5, 6])
        alone = gym.DriveNeedle()
        np.testing.assert_array_equal(first[1], alone.reset(seed=6)[0])
        for _ in range(20):
            both = envs.step(np.array([[0.5, 0, 0]] * 2))[0]
            one = alone.step(np.array([0.5, 0, 0]))[0]
        np.testing.assert_array_equal(both[1], one)
        envs.close()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
