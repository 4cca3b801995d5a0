#pragma once

#include <string>
#include <string_view>

namespace isthmus {

/// What the reason of a refused order (answer_t), or the remark on one that is done, means: a sentence
/// without its capital and full stop. Empty where the word says all that can be said.
std::string_view sentence_of_order(std::string_view reason);

/// The same of a question (reply_t), which the answer may refuse for the same reasons as an order.
std::string_view sentence_of_question(std::string_view reason);

/// "reason: sentence", or the reason alone where the sentence is empty.
std::string with_sentence(std::string_view reason, std::string_view sentence);

}  // namespace isthmus
