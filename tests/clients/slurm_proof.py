"""A real Slurm makes a shot: two nodes, one of which dies in the middle; tasks that fail, and a retry. The result is that of
this machine alone, bit for bit.
"""
import glob
import json
import os
import subprocess

import client
import slurm_cluster

FRAMES = 4
# Frames that take a while: the node must die while one is traced.
WORK = ["--set", "shot.frames=[1,%d]" % FRAMES, "--set", "render.samples=4000", "--set", "output.movie=true"]


def farm(shot, folder, *options, status=0):
    ran = subprocess.run([client.SOFTREEL, "farm", shot, "--output", folder] + list(options), capture_output=True, text=True)
    client.check(ran.returncode == status, "farm %s: status %d instead of %d\n%s%s" %
                 (" ".join(options), ran.returncode, status, ran.stdout, ran.stderr))
    return ran.stdout + ran.stderr


def tasks(shot, folder, status=0):
    """What farm --status says of each task, by name."""
    ran = subprocess.run([client.SOFTREEL, "farm", shot, "--output", folder, "--status", "--json"], capture_output=True, text=True)
    client.check(ran.returncode == status, "farm --status: status %d\n%s" % (ran.returncode, ran.stdout + ran.stderr))
    return {"%s %d-%d" % (task["step"], *task["frames"]): task for task in json.loads(ran.stdout)["shots"][0]["tasks"]}


def pictures(folder):
    files = {}
    for path in glob.glob(os.path.join(folder, "*.png")) + glob.glob(os.path.join(folder, "*.mp4")):
        with open(path, "rb") as f:
            files[os.path.basename(path)] = f.read()
    return files


def queue():
    return client.run_program(["squeue", "-h", "-o", "%i %T %r"]).splitlines()


def prove_death_of_a_node(cluster, shot, folder, alone):
    farm(shot, folder, "--chunk", "1", "--cpus", "1", "--memory", "900M", *WORK)
    doomed, saved = cluster.nodes

    def node_traces():
        return any("--only" in slurm_cluster.read_text("/proc/%s/cmdline" % pid) for pid in cluster.processes_of(doomed))

    cluster.wait_for("a frame to be traced on %s" % doomed, node_traces, 120)
    struck = [name for name, task in tasks(shot, folder).items() if task["state"] == "running" and task["node"] == doomed]
    cluster.kill_node(doomed)
    client.check(struck, "no task was running on %s" % doomed)
    farm(shot, folder, "--retry", "--wait")
    after = tasks(shot, folder)
    client.check(all(task["state"] == "done" for task in after.values()), "not all tasks are done: %s" % after)
    for name in struck:
        client.check(after[name]["node"] == saved, "%s was lost with its node and done on %s" % (name, after[name]["node"]))
    client.check(pictures(folder) == alone, "the farm's files are not those of this machine alone")
    client.check("nothing to do" in farm(shot, folder, *WORK), "farm does not say that nothing is left to do")


def prove_failure_and_retry(cluster, shot, folder, alone):
    node = cluster.nodes[1]
    farm(shot, folder, "--chunk", "2", "--cpus", "1", "--memory", "900M", "--sbatch=--hold", *WORK)
    client.check("JobHeldUser" in json.dumps(tasks(shot, folder, status=1)), "a task that is held is not called stuck")
    # From now on the node sees another folder than the machine that submitted.
    token, = glob.glob(os.path.join(folder, ".cache", ".farm-*"))
    os.rename(token, token + ".hidden")
    client.run_program(["scontrol", "release"] + [line.split()[0].split("_")[0] for line in queue()])
    said = farm(shot, folder, "--status", "--wait", status=1)
    states = tasks(shot, folder, status=1)
    simulate = states["simulate 1-%d" % FRAMES]
    client.check(simulate["state"] == "failed" and simulate["node"] == node, "simulate: %s" % simulate)
    client.check(os.path.join(folder, ".cache") in simulate["said"] and node in simulate["said"], simulate["said"])
    client.check(os.path.exists(simulate["log"]) and simulate["log"] in said, "the log is not named: %s" % said)
    cluster.wait_for("what depends on the failed task to leave the queue", lambda: not queue(), 60)
    os.rename(token + ".hidden", token)
    farm(shot, folder, "--retry", "--wait", "--sbatch=--nice=1")
    client.check(pictures(folder) == alone, "the retried files are not those of this machine alone")


def main():
    with client.work_folder() as folder:
        cluster_folder = os.path.join(folder, "cluster")
        os.makedirs(cluster_folder)
        cluster = slurm_cluster.Cluster(cluster_folder, ["east", "west"])
        shot = client.make_shot(folder)
        client.softreel("render", shot, "--output", os.path.join(folder, "alone"), *WORK)
        alone = pictures(os.path.join(folder, "alone"))
        client.check(len(alone) == FRAMES + 1, "this machine alone made %s" % sorted(alone))
        with cluster:
            prove_death_of_a_node(cluster, shot, os.path.join(folder, "first"), alone)
            prove_failure_and_retry(cluster, shot, os.path.join(folder, "second"), alone)


if __name__ == "__main__":
    main()
