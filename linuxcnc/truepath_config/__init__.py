# SPDX-License-Identifier: GPL-2.0-or-later
"""The operator's side of Truepath on LinuxCNC: what runs, where its origin lies, arming and what to tell."""
