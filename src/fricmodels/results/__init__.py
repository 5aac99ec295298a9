"""Results as typed documents: comparison, diagnosis, ladder and leaderboard as other programs read them.

Terminal, report, notebook and exports are views of these.
"""
