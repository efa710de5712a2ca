"""Multiplies a dataset on two Ray nodes, in two network namespaces of one machine, of which one is killed while it works.

    sudo python two_nodes.py [IMAGES]

Prints rows of a table: what the killed node cost, and how many files differ from those of one process. Fails where any does. Needs
root, for the namespaces, and the packages aquafuse, ray and opencv-python-headless.
"""

import filecmp
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import aquafuse
import cv2

EXAMPLE = Path(__file__).parents[2] / "python/examples/ray_augment.py"
NODES = ["aquafuse-1", "aquafuse-2"]
ADDRESSES = ["10.77.0.1", "10.77.0.2"]
PARTS = "16"


def run(*words, **options):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, **options)


def inside(node, *words, **options):
    return run("ip", "netns", "exec", NODES[node], *words, **options)


def begin():
    """Two namespaces, a cable between them, a node of one processor in each."""
    for node in NODES:
        run("ip", "netns", "add", node)
    run("ip", "link", "add", "aq1", "netns", NODES[0], "type", "veth", "peer", "name", "aq2", "netns", NODES[1])
    for node, address in enumerate(ADDRESSES):
        inside(node, "ip", "addr", "add", f"{address}/24", "dev", f"aq{node + 1}")
        for device in ("lo", f"aq{node + 1}"):
            inside(node, "ip", "link", "set", device, "up")
    common = ["--num-cpus=1", "--disable-usage-stats", "--object-store-memory=100000000"]
    ray = Path(sys.executable).with_name("ray")
    inside(0, ray, "start", "--head", f"--node-ip-address={ADDRESSES[0]}", "--include-dashboard=false", *common)
    inside(1, ray, "start", f"--address={ADDRESSES[0]}:6379", f"--node-ip-address={ADDRESSES[1]}", *common)


def end():
    for node in NODES:
        kill(node)
        subprocess.run(["ip", "netns", "del", node], capture_output=True)


def kill(node):
    """Every process of a node, at once."""
    found = subprocess.run(["ip", "netns", "pids", node], capture_output=True, text=True)
    for process in found.stdout.split():
        try:
            os.kill(int(process), signal.SIGKILL)
        except ProcessLookupError:
            pass


def multiply(dataset, output, killed):
    """Seconds that it takes; a node is killed when a third is done."""
    began = time.monotonic()
    words = ["ip", "netns", "exec", NODES[0], sys.executable, EXAMPLE, dataset, output, PARTS]
    job = subprocess.Popen(
        [str(word) for word in words],
        env=os.environ | {"RAY_ADDRESS": f"{ADDRESSES[0]}:6379"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    wanted = 2 * len(list(dataset.iterdir())) // 3
    while killed and job.poll() is None:
        if sum(1 for _ in output.rglob("*.png")) >= wanted:
            kill(NODES[1])
            killed = False
        time.sleep(0.05)
    said, _ = job.communicate()
    if job.returncode != 0:
        sys.exit(said)
    return time.monotonic() - began


def files(folder):
    """All but the lists of parts, from which the whole list is joined."""
    found = (path for path in folder.rglob("*") if path.is_file() and ".shard-" not in path.name)
    return {path.relative_to(folder): path for path in found}


def different(one, other):
    """Files that only one has, or whose bytes differ."""
    one, other = files(one), files(other)
    equal = (name for name in one.keys() & other.keys() if filecmp.cmp(one[name], other[name], shallow=False))
    return (one.keys() | other.keys()) - set(equal)


def main():
    if os.geteuid() != 0:
        sys.exit("network namespaces need root; run this by sudo")
    images = int(sys.argv[1]) if len(sys.argv) > 1 else 240
    base = Path(tempfile.mkdtemp(prefix="two_nodes"))
    dataset = base / "reef"
    dataset.mkdir()
    for number in range(images):
        cv2.imwrite(str(dataset / f"{number}.png"), aquafuse.example.reef(480, 640 + number)[..., ::-1])
    alone = base / "alone"
    settings = {"per_image": 2, "theta_range": (0.0, 60.0), "seed": 7, "progress": False}
    aquafuse.augment(str(dataset), ["presets"], str(alone), threads=1, **settings)
    for name, how in (("both", "two nodes"), ("killed", "two nodes, one of them killed after a third")):
        try:
            begin()
            seconds = multiply(dataset, base / name, killed=name == "killed")
        finally:
            end()
        wrong = different(alone, base / name)
        print(f"| {how} | {len(files(base / name))} | {len(wrong)} | {seconds:.1f} |")
        if wrong:
            sys.exit(f"these differ: {sorted(map(str, wrong))[:9]}; see {base}")
    shutil.rmtree(base)


if __name__ == "__main__":
    main()
