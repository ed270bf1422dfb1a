"""Web pages that show a result: `view` to explore it, `report` to send it to a colleague.

Each page is one file that a browser opens without a network. Begin with `run_view`, which chooses what of a run goes
into its page, and `parts/view.js`, which shows it; `page` puts the parts together.
"""
