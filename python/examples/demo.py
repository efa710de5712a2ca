"""A page in the browser: drop an image, choose a water.

    python demo.py

Needs gradio, and aquafuse. It is not on PyPI yet; docs/python.md says how to build it.
"""

import aquafuse
import gradio
import numpy as np


def fuse(image: np.ndarray, water: str, model: str, theta: float) -> tuple[np.ndarray, str]:
    """What the page shows for its settings."""
    fused, report = aquafuse.Fuser(f"preset:{water}", model=model).fuse_with_report(image, theta=theta)
    return fused, f"estimate {report.verdict} {', '.join(report.reasons)}; change {report.change:.1f} ΔE"


def page() -> gradio.Interface:
    """The page; it listens on this machine alone."""
    return gradio.Interface(
        fuse,
        inputs=[
            gradio.Image(label="image", value=aquafuse.example.reef(240, 320)),
            gradio.Dropdown(aquafuse.Water.presets(), value="jerlov-3C", label="water"),
            gradio.Radio(["physical", "aquafuse", "exchange"], value="physical", label="model"),
            gradio.Slider(0, 90, value=0, label="theta, degrees"),
        ],
        outputs=[gradio.Image(label="fused"), gradio.Text(label="report")],
        title="AquaFuse",
    )


if __name__ == "__main__":
    page().launch(server_name="127.0.0.1")
