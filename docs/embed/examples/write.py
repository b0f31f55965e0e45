"""A scene written in Python: how far threads of several stiffnesses sag, each in its own thread."""
from concurrent.futures import ThreadPoolExecutor

import sutura


def sag(young: float) -> float:
    """Of 100 mm of thread that is held level at one end (m)."""
    scene = sutura.Scene(plugins=["thread", "tools"], dt="10 ms")
    thread = scene.add("SutureThread", name="suture", needle_length=0, tip=[0, 0, 0],
                       tip_direction=[-1, 0, 0], thread_length="100 mm", thread_beams=40,
                       thread_diameter="0.2 mm", thread_young=young, thread_density=910)
    scene.add("Track", times=0)
    scene.add("Grasper", body=thread, at=0)
    with scene.load() as sim:
        sim.step(300)
        return -sim["/suture"].positions[-1, 2]


stiffnesses = [0.5e9, 1e9, 2e9, 4e9]
with ThreadPoolExecutor(2) as workers:
    for young, depth in zip(stiffnesses, workers.map(sag, stiffnesses)):
        print(f"{young / 1e9:.1f} GPa: {1e3 * depth:.1f} mm")

try:
    scene = sutura.Scene(plugins=["thread"])
    scene.add("SutureThread", thread_lenght="5 cm")
    scene.load()
except sutura.SceneError as error:
    print(error)  # names this file, this line, and the attribute that was meant
