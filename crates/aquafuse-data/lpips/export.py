"""Writes the network of LPIPS as ONNX, for `aquafuse evaluate fusion --lpips-weights FILE`.

    pip install torch torchvision lpips onnx onnxscript
    python export.py squeeze lpips_squeeze.onnx

The first word is the network: alex, vgg or squeeze. Its weights are fetched by torchvision, those of LPIPS come with its
package; see both for their terms. Without a network at hand, `--random` writes one of random weights, to try things out.
"""

import sys

import lpips
import torch


def without_rounding_up(module):
    """Pools that round up become pools that round down over a border of zeros, since runtimes disagree about the former.

    They follow a ReLU, so that no zero of the border is a maximum that was not there.
    """
    for name, inner in module.named_children():
        if isinstance(inner, torch.nn.MaxPool2d) and inner.ceil_mode:
            border = torch.nn.ConstantPad2d((0, inner.stride - 1, 0, inner.stride - 1), 0.0)
            pool = torch.nn.MaxPool2d(inner.kernel_size, inner.stride)
            setattr(module, name, torch.nn.Sequential(border, pool))
        else:
            without_rounding_up(inner)


def main(network, path, random):
    model = lpips.LPIPS(net=network, pnet_rand=random, verbose=False).eval()
    without_rounding_up(model)
    # Both sides are free; the numbers only have to be large enough for every layer.
    picture = torch.rand(1, 3, 96, 128) * 2 - 1
    sides = {2: "height", 3: "width"}
    torch.onnx.export(
        model,
        (picture, picture.flip(3)),
        path,
        input_names=["a", "b"],
        output_names=["distance"],
        dynamic_axes={"a": sides, "b": sides},
        opset_version=17,
        dynamo=False,
    )


if __name__ == "__main__":
    words = [word for word in sys.argv[1:] if word != "--random"]
    if len(words) != 2:
        sys.exit(__doc__)
    main(*words, "--random" in sys.argv)
