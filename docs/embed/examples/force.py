"""The first stitch, and the forces of its two needle holders as curves."""
import matplotlib.pyplot as plt
import numpy as np
import sutura

sim = sutura.load(sutura.scenes / "suture/first_stitch.xml")
names = ["/tools/holder.force", "/tools/puller.force"]
curves = np.array([[r.time, *(np.linalg.norm(sim[n]) for n in names)] for r in sim.run()])
plt.plot(curves[:, 0], curves[:, 1:], label=names)
plt.xlabel("time [s]"), plt.ylabel("force [N]"), plt.legend()
plt.savefig("force.png")
