"""A gripper of MuJoCo drives a needle of Sutura: poses go one way, forces the other."""
from __future__ import annotations

import sys

import mujoco
import numpy as np
import sutura

# A hand of 50 g that slides along x, y, z and turns about the centre of the needle's arc, which is
# where the body's origin is; servos hold it where it is told to be.
GRIPPER = """<mujoco>
  <option timestep="0.0005" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="hand" pos="0 0 0.005">
      <joint name="x" type="slide" axis="1 0 0" damping="4"/>
      <joint name="y" type="slide" axis="0 1 0" damping="4"/>
      <joint name="z" type="slide" axis="0 0 1" damping="4"/>
      <joint name="turn" type="hinge" axis="0 -1 0" damping="0.01"/>
      <inertial pos="0 0 0" mass="0.05" diaginertia="5e-5 5e-5 5e-5"/>
    </body>
  </worldbody>
  <actuator>
    <position joint="x" kp="800"/> <position joint="y" kp="800"/> <position joint="z" kp="800"/>
    <position joint="turn" kp="0.5"/>
  </actuator>
</mujoco>"""


def pose_of(hand, origin):
    """Motion of the hand away from where it was modelled, as Sutura has it."""
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, hand.xquat)
    return hand.xpos - rotation.reshape(3, 3) @ origin, hand.xquat.copy()


def run(dt: float, duration: float = 0.8, speed: float = np.radians(100)) -> dict:
    """Both for `duration` seconds, exchanging every `dt`; the turn is told to go on at `speed`."""
    sim = sutura.load(sutura.scenes / "suture/prick.xml", settings={".dt": f"{dt} s"})
    model = mujoco.MjModel.from_xml_string(GRIPPER)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    hand = data.body("hand")
    origin = hand.xpos.copy()
    given = taken = 0.0  # J: by the hand, and by the needle
    poses, forces = [], []
    force = moment = np.zeros(3)  # of the jaws on the needle, about the hand's origin
    for _ in range(round(duration / dt)):
        before = data.qpos.copy()
        data.xfrc_applied[hand.id] = np.concatenate([-force, -moment])
        for _ in range(round(dt / model.opt.timestep)):
            data.ctrl[3] = speed * data.time
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        moved = data.qpos - before
        given += force @ moved[:3] - moment[1] * moved[3]

        poses.append(pose_of(hand, origin))
        sim["/track"].pose = poses[-1]
        sim.step()
        force = np.asarray(sim["/grasper.force"])
        arm = np.asarray(sim["/grasper.target"]) - hand.xpos
        moment = np.asarray(sim["/grasper.moment"]) + np.cross(arm, force)
        taken += force @ moved[:3] - moment[1] * moved[3]
        forces.append(force)
    return {"given": given, "taken": taken, "poses": poses, "forces": np.array(forces),
            "punctures": sim["/puncture.punctures"], "late": speed * data.time - data.qpos[3]}


if __name__ == "__main__":
    for milliseconds in map(float, sys.argv[1:] or ["10", "5"]):
        r = run(milliseconds * 1e-3)
        print(f"every {milliseconds:g} ms: {r['punctures']:g} puncture, "
              f"up to {np.linalg.norm(r['forces'], axis=1).max():.3f} N, "
              f"work {1e3 * r['taken']:.4f} mJ, "
              f"of which the exchange made {1e3 * (r['taken'] - r['given']):.4f} mJ")
