"""The publications of the field's ledger, each with how well it is known."""

from rubnoise.claims.field import Known, Publication


def _source(label: str, name: str, doi: str | None, known: Known) -> Publication:
    return Publication(label=label, name=name, doi=doi, known=known)


THIS_MODEL = _source("rubnoise", "rubnoise, theory.md", None, Known.PROOF)
CAMPBELL_RICE = _source(
    "Campbell, Rice 1944", "Campbell 1909; Rice 1944", "10.1002/j.1538-7305.1944.tb00874.x", Known.PROOF
)
BA_2010 = _source(
    "Ben Abdelounis 2010",
    "Ben Abdelounis, Le Bot, Perret-Liaudet, Zahouani 2010",
    "10.1016/j.wear.2009.08.024",
    Known.SECOND_HAND,
)
BA_2011 = _source(
    "Ben Abdelounis 2011",
    "Ben Abdelounis, Zahouani, Le Bot, Perret-Liaudet, Ben Tkaya 2011",
    "10.1016/j.wear.2010.07.014",
    Known.SECOND_HAND,
)
BREWER_2016 = _source("Brewer 2016", "Brewer, Meyer, Peshkin, Colgate 2016", None, Known.ABSTRACT)
DANG_2013 = _source(
    "Dang 2013", "Dang, Perret-Liaudet, Scheibert, Le Bot 2013", "10.1007/s00466-013-0870-7", Known.SECOND_HAND
)
FINGER_2011 = _source(
    "Wiertlewski 2011", "Wiertlewski, Hudin, Hayward 2011", "10.1007/978-1-4471-4841-8_7", Known.ABSTRACT
)
JIBIKI_2001 = _source("Jibiki 2001", "Jibiki, Shima, Akita, Tamura 2001", None, Known.ABSTRACT)
KILBURN_1974 = _source("Kilburn 1974", "Kilburn 1974", "10.1115/1.3451945", Known.ABSTRACT)
PONTHUS_2019 = _source(
    "Ponthus 2019",
    "Ponthus, Scheibert, Thogersen, Malthe-Sorenssen, Perret-Liaudet 2019",
    "10.1103/PhysRevE.99.023004",
    Known.ABSTRACT,
)
RABINOWICZ_1955 = _source("Rabinowicz 1955", "Rabinowicz, Rightmire, Tedholm, Williams 1955", None, Known.ABSTRACT)
RABINOWICZ_1956 = _source("Rabinowicz 1956", "Rabinowicz 1956", None, Known.ABSTRACT)
SPEED_2019 = _source(
    "Roughness noise 2019", "Influence of sliding speed on roughness noise, 2019", None, Known.ABSTRACT
)
STOIMENOV_2007 = _source("Stoimenov 2007", "Stoimenov, Maruyama, Adachi, Kato 2007", None, Known.ABSTRACT)
XU_2025 = _source("Xu 2025", "Xu, Zhou, Persson 2025", "10.1039/D5SM00617A", Known.ABSTRACT)
ZOUABI_2016 = _source("Zouabi 2016", "Zouabi 2016", None, Known.ABSTRACT)
