"""The publications of the field's ledger, each with how well it is known."""

from rubnoise.claims.field import Known, Publication


def _source(name: str, doi: str | None, known: Known) -> Publication:
    return Publication(name=name, doi=doi, known=known)


THIS_MODEL = _source("rubnoise, theory.md", None, Known.PROOF)
CAMPBELL_RICE = _source("Campbell 1909; Rice 1944", "10.1002/j.1538-7305.1944.tb00874.x", Known.PROOF)
BA_2010 = _source("Ben Abdelounis, Le Bot, Perret-Liaudet, Zahouani 2010", "10.1016/j.wear.2009.08.024", Known.ABSTRACT)
BA_2010_NUMBERS = _source(BA_2010.name, BA_2010.doi, Known.SECOND_HAND)
BA_2011 = _source(
    "Ben Abdelounis, Zahouani, Le Bot, Perret-Liaudet, Ben Tkaya 2011", "10.1016/j.wear.2010.07.014", Known.SECOND_HAND
)
BREWER_2016 = _source("Brewer, Meyer, Peshkin, Colgate 2016", None, Known.ABSTRACT)
DANG_2013 = _source("Dang, Perret-Liaudet, Scheibert, Le Bot 2013", "10.1007/s00466-013-0870-7", Known.SECOND_HAND)
FINGER_2011 = _source("Wiertlewski, Hudin, Hayward 2011", "10.1007/978-1-4471-4841-8_7", Known.ABSTRACT)
JIBIKI_2001 = _source("Jibiki, Shima, Akita, Tamura 2001", None, Known.ABSTRACT)
KILBURN_1974 = _source("Kilburn 1974", "10.1115/1.3451945", Known.ABSTRACT)
OTHMAN_SEIREG_1990 = _source("Othman, Elkholy, Seireg 1990", "10.1007/BF02321499", Known.ABSTRACT)
PONTHUS_2019 = _source(
    "Ponthus, Scheibert, Thogersen, Malthe-Sorenssen, Perret-Liaudet 2019",
    "10.1103/PhysRevE.99.023004",
    Known.ABSTRACT,
)
RABINOWICZ_1955 = _source("Rabinowicz, Rightmire, Tedholm, Williams 1955", None, Known.ABSTRACT)
RABINOWICZ_1956 = _source("Rabinowicz 1956", None, Known.ABSTRACT)
SPEED_2019 = _source("Influence of sliding speed on roughness noise, 2019", None, Known.ABSTRACT)
STOIMENOV_2007 = _source("Stoimenov, Maruyama, Adachi, Kato 2007", None, Known.ABSTRACT)
XU_2025 = _source("Xu, Zhou, Persson 2025", "10.1039/D5SM00617A", Known.ABSTRACT)
ZOUABI_2016 = _source("Zouabi 2016", None, Known.ABSTRACT)
