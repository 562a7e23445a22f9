"""A cluster of its own on this machine: munged, slurmctld and one slurmd a node, on free ports of loopback, as the
user who asks. Nothing of an installed cluster is touched or asked.
"""
import getpass
import os
import shutil
import signal
import socket
import subprocess
import time

import client

CONFIGURATION = """ClusterName=proof
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.sock,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
MpiDefault=none
ReturnToService=2
SlurmdTimeout=10
KillWait=2
SchedulerParameters=sched_interval=2,bf_interval=2
{nodes}
PartitionName=all Nodes={names} Default=YES MaxTime=60 State=UP
"""


def find(program):
    """A program that may lie where only administrators look."""
    path = shutil.which(program, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")
    return path or client.skip("no %s on PATH" % program)


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def read_text(path):
    try:
        with open(path, "rb") as f:
            return f.read().decode("utf-8", "replace")
    except OSError:
        return ""


def environment_of(pid):
    return read_text("/proc/%s/environ" % pid).split("\0")


def parent_of(pid):
    stat = read_text("/proc/%s/stat" % pid)
    return int(stat.rsplit(")", 1)[1].split()[1]) if stat else 0


def kill(pid):
    try:
        os.kill(int(pid), signal.SIGKILL)
    except (OSError, ValueError):
        pass  # it has ended


class Cluster:
    """with Cluster(folder, ["east", "west"]): the nodes are up, and SLURM_CONF names this cluster."""

    def __init__(self, folder, nodes):
        self.folder, self.nodes = folder, nodes
        self.programs = {name: find(name) for name in ("munged", "slurmctld", "slurmd")}
        for name in ("sbatch", "squeue", "scancel", "scontrol", "sinfo"):
            client.need_program(name)

    def __enter__(self):
        os.makedirs(os.path.join(self.folder, "state"))
        ports = free_ports(1 + len(self.nodes))
        lines = ["NodeName=%s NodeHostname=%s NodeAddr=127.0.0.1 Port=%d CPUs=1 RealMemory=2000" %
                 (node, socket.gethostname(), port) for node, port in zip(self.nodes, ports[1:])]
        self.configuration = os.path.join(self.folder, "slurm.conf")
        with open(self.configuration, "w", encoding="utf-8") as f:
            f.write(CONFIGURATION.format(host=socket.gethostname(), ports=ports, user=getpass.getuser(), folder=self.folder,
                                         nodes="\n".join(lines), names=",".join(self.nodes)))
        os.environ["SLURM_CONF"] = self.configuration
        try:
            self.start()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()

    def start(self):
        key = os.path.join(self.folder, "munge.key")
        with open(os.open(key, os.O_CREAT | os.O_WRONLY, 0o600), "wb") as f:
            f.write(os.urandom(128))
        client.run_program([self.programs["munged"], "--force", "--key-file=" + key] +
                           ["--%s=%s/munge.%s" % (option, self.folder, end) for option, end in
                            (("socket", "sock"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"))])
        client.run_program([self.programs["slurmctld"], "-c", "-f", self.configuration])
        for node in self.nodes:
            client.run_program([self.programs["slurmd"], "-N", node, "-f", self.configuration])
        self.wait_for("all nodes to be idle", lambda: self.states() == ["idle"] * len(self.nodes), 60)

    def states(self):
        ran = subprocess.run(["sinfo", "-h", "-N", "-o", "%T"], capture_output=True, text=True)
        return ran.stdout.split()

    def wait_for(self, what, condition, seconds):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                logs = "\n".join(read_text(os.path.join(self.folder, name))[-3000:]
                                 for name in ["slurmctld.log"] + ["slurmd-%s.log" % node for node in self.nodes])
                client.check(False, "waited %d s for %s\n%s" % (seconds, what, logs))
            time.sleep(0.05)

    def processes_of(self, node):
        """Processes of tasks on a node: they were started with this cluster's configuration and the node's name."""
        marks = {"SLURM_CONF=" + self.configuration, "SLURMD_NODENAME=" + node}
        return [pid for pid in os.listdir("/proc") if pid.isdigit() and marks <= set(environment_of(pid))]

    def kill_node(self, node):
        """As if its power had gone: the daemon, what watches its tasks, and the tasks."""
        kill(read_text(os.path.join(self.folder, "slurmd-%s.pid" % node)))
        tasks = self.processes_of(node)
        watchers = {parent_of(pid) for pid in tasks}
        for pid in [pid for pid in watchers if read_text("/proc/%d/comm" % pid).startswith("slurmstepd")] + tasks:
            kill(pid)

    def stop(self):
        for node in self.nodes:
            self.kill_node(node)
        for name in ("slurmctld.pid", "munge.pid"):
            kill(read_text(os.path.join(self.folder, name)))
