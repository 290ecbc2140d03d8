#!/usr/bin/python3
# SPDX-FileCopyrightText: 2026 The fdp_stereo authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what rqt_reconfigure shows of cfg/Disparity.cfg, from that file: draw_tuning_window.py >docs/images/tuning_window.svg"""
import os
import sys
import types
from html import escape

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
WIDTH, ROW, NAME, BAR, VALUE = 760, 24, 20, 300, 620


class Generator:
    """What the cfg file uses of dynamic_reconfigure's generator: it keeps the groups and their parameters."""

    def __init__(self):
        self.groups = []

    def add_group(self, name, state=True, **_):
        group = Generator()
        group.name, group.open, group.rows = name, state, []
        self.groups.append(group)
        return group

    def add(self, name, kind, _level, _text, default, low=None, high=None, edit_method=None):
        if edit_method:
            default = dict((value, text) for text, value in edit_method)[default]
        self.rows.append((name, default, low, high, edit_method))

    def const(self, _name, _kind, value, text):
        return text, value

    def enum(self, constants, _text):
        return constants

    def generate(self, *_):
        return 0


def text(x, y, words, style=""):
    return f'<text x="{x}" y="{y + 16}" {style}>{escape(str(words))}</text>'


def box(x, y, width, style):
    return f'<rect x="{x}" y="{y + 5}" width="{width}" height="14" rx="2" {style}/>'


def draw_row(y, name, default, low, high, choices):
    if isinstance(default, bool):
        value = box(BAR, y, 14, 'fill="#fff" stroke="#888"') + (text(BAR + 2, y, "✓") if default else "")
    elif choices:
        value = box(BAR, y, 200, 'fill="#fff" stroke="#888"') + text(BAR + 6, y, f"{default}  ▾", 'font-size="12"')
    else:
        place = BAR + 200 * (default - low) / (high - low)
        value = (text(BAR - 8, y, low, 'text-anchor="end" fill="#888"') + f'<rect x="{BAR}" y="{y + 10}" width="200" height="4" fill="#ccc"/>' +
                 f'<circle cx="{place:.1f}" cy="{y + 12}" r="6" fill="#3584e4"/>' + text(BAR + 208, y, high, 'fill="#888"') +
                 text(VALUE, y, default))
    return text(NAME, y, name) + value


def main():
    generator = Generator()
    module = types.ModuleType("generator")
    module.ParameterGenerator = lambda: generator
    module.bool_t = module.double_t = module.int_t = module.str_t = None
    sys.modules.update({"dynamic_reconfigure": module, "dynamic_reconfigure.parameter_generator_catkin": module})
    with open(os.path.join(ROOT, "cfg", "Disparity.cfg"), encoding="utf-8") as file:
        exec(file.read(), {"exit": lambda _: None})  # the cfg file is a program
    y, parts = 8, []
    for group in sorted(generator.groups, key=lambda group: group.name):
        parts.append(text(8, y, f"{'▾' if group.open else '▸'} {group.name}", 'font-weight="bold"'))
        y += ROW
        for row in group.rows if group.open else ():
            parts.append(draw_row(y, *row))
            y += ROW
    print(f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{y + 8}" font-family="sans-serif" font-size="13">\n'
          f'<rect width="{WIDTH}" height="{y + 8}" fill="#f6f5f4"/>')
    print("\n".join(parts) + "\n</svg>")


main()
