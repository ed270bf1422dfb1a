"""Web pages that show a result: `view` to explore it, `report` to send it to a colleague.

Each page is one file that a browser opens without a network. Begin with `run_view`, which chooses the data of a run
for its page, and `parts/view.js`, which shows them; `page` puts the parts together.
"""
