"""A small segmenter and its training, on the CPU."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

CLASSES = 6
WIDTHS = (8, 16, 32)
GROUPS = 4


def new(seed):
    """The weights of a U-Net of three levels."""
    key = jax.random.PRNGKey(seed)
    layers = {}

    def conv(name, size, into, out):
        nonlocal key
        key, own = jax.random.split(key)
        scale = (2 / (size * size * into)) ** 0.5
        layers[name] = {
            "kernel": scale * jax.random.normal(own, (size, size, into, out)),
            "bias": jnp.zeros(out),
            "gain": jnp.ones(out),
        }

    into = 3
    for level, width in enumerate(WIDTHS):
        conv(f"down{level}a", 3, into, width)
        conv(f"down{level}b", 3, width, width)
        into = width
    for level, width in reversed(list(enumerate(WIDTHS[:-1]))):
        conv(f"up{level}a", 3, into + width, width)
        conv(f"up{level}b", 3, width, width)
        into = width
    conv("last", 1, into, CLASSES)
    return layers


def convolved(layer, x):
    kernel = layer["kernel"]
    return jax.lax.conv_general_dilated(x, kernel, (1, 1), "SAME", dimension_numbers=("NHWC", "HWIO", "NHWC"))


def block(layer, x):
    """Convolution, group normalisation, ReLU."""
    x = convolved(layer, x)
    count, height, width, channels = x.shape
    grouped = x.reshape(count, height, width, GROUPS, channels // GROUPS)
    mean = grouped.mean((1, 2, 4), keepdims=True)
    spread = jnp.sqrt(grouped.var((1, 2, 4), keepdims=True) + 1e-5)
    x = ((grouped - mean) / spread).reshape(x.shape)
    return jax.nn.relu(layer["gain"] * x + layer["bias"])


def halved(x):
    return jax.lax.reduce_window(x, 0.0, jax.lax.add, (1, 2, 2, 1), (1, 2, 2, 1), "VALID") / 4


def scores(layers, pictures):
    """How much speaks for each class, pixel by pixel; images are in 0..1."""
    x, kept = 2 * pictures - 1, []
    for level in range(len(WIDTHS)):
        x = block(layers[f"down{level}b"], block(layers[f"down{level}a"], x))
        if level + 1 < len(WIDTHS):
            kept.append(x)
            x = halved(x)
    for level in reversed(range(len(WIDTHS) - 1)):
        x = jnp.concatenate([x.repeat(2, 1).repeat(2, 2), kept[level]], -1)
        x = block(layers[f"up{level}b"], block(layers[f"up{level}a"], x))
    return convolved(layers["last"], x) + layers["last"]["bias"]


def loss(layers, pictures, labels):
    likelihoods = jax.nn.log_softmax(scores(layers, pictures))
    return -jnp.take_along_axis(likelihoods, labels[..., None], -1).mean()


@partial(jax.jit, donate_argnums=(0, 1))
def step(layers, moments, count, rate, pictures, labels):
    """One step of Adam."""
    slope = jax.grad(loss)(layers, pictures, labels)
    first = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, moments[0], slope)
    second = jax.tree.map(lambda m, g: 0.99 * m + 0.01 * g * g, moments[1], slope)

    def moved(layer, m, v):
        return layer - rate * (m / (1 - 0.9**count)) / (jnp.sqrt(v / (1 - 0.99**count)) + 1e-8)

    return jax.tree.map(moved, layers, first, second), (first, second)


def trained(batches, steps, seed):
    """A network after `steps` batches of images (bytes) and labels."""
    layers = new(seed)
    moments = (jax.tree.map(jnp.zeros_like, layers), jax.tree.map(jnp.zeros_like, layers))
    for count in range(1, steps + 1):
        pictures, labels = next(batches)
        rate = 3e-3 * 0.5 * (1 + np.cos(np.pi * count / steps))
        layers, moments = step(layers, moments, float(count), rate, pictures / np.float32(255), labels)
    return layers


predicted = jax.jit(lambda layers, pictures: scores(layers, pictures).argmax(-1))


def mean_iou(layers, pictures, labels):
    """Intersection over union of each class that is there, and their mean."""
    told = np.concatenate([predicted(layers, part / np.float32(255)) for part in np.array_split(pictures, 8)])
    pairs = np.bincount((CLASSES * labels + told).ravel(), minlength=CLASSES**2).reshape(CLASSES, CLASSES)
    both = np.diag(pairs)
    either = pairs.sum(0) + pairs.sum(1) - both
    there = pairs.sum(1) > 0
    return (both[there] / either[there]).mean()
