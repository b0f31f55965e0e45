"""The first stitch, and the forces of its two needle holders as curves."""
import matplotlib.pyplot as plt
import numpy as np
import sutura

sim = sutura.load(sutura.scenes / "suture/first_stitch.xml")
names = ["/tools/holder.force", "/tools/puller.force"]
curves = [[r.time, *(np.linalg.norm(sim[name]) for name in names)] for r in sim.run()]
time, *forces = np.transpose(curves)
plt.plot(time, np.transpose(forces), label=names)
plt.xlabel("time [s]"), plt.ylabel("force [N]"), plt.legend()
plt.savefig("force.png")
