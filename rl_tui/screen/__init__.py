"""All that draws: the terminal, panels, dialogs and screens. It sees a run by its snapshots only.

It imports live, and the rooms below.
"""
