"""Every picture that rubnoise draws: of a run, of a sweep, of a scenario's theory, and the figures of the paper.

Begin with `catalogue` for the pictures of a run, and with `paper` for the figures of the paper.
`style` holds colours, titles and legends; `stretch` reads the part of a run that a picture shows.
"""
